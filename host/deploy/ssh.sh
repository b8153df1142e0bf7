# shellcheck shell=sh
# How deploy.sh reaches the brick: its address, ssh, and what to do if ssh fails.

# Addresses, by the rules of host/link/logins.py: a name, an IPv6 address in brackets and without,
# a port.
plain='[A-Za-z0-9._+][A-Za-z0-9._+-]*'
zone='(%[A-Za-z0-9._-]+)?'
boxed="\[[0-9A-Fa-f.]*:[0-9A-Fa-f:.]*$zone\]"
bare="[0-9A-Fa-f.]*:[0-9A-Fa-f.]*:[0-9A-Fa-f:.]*$zone"
digits='[1-9][0-9]{0,4}'
address() { # address TEXT: take [ssh://][USER@]HOST[:PORT] apart; non-zero if it is none
    user='' port='' rest=${1#ssh://}
    [ "$rest" = "$1" ] || rest=${rest%/}
    printf '%s' "$rest" | tr '\n' ' ' |
        LC_ALL=C grep -Eqx "($plain@)?($boxed(:$digits)?|$bare|$plain(:$digits)?)" || return 1
    case $rest in *@*) user=${rest%@*} rest=${rest#*@} ;; esac
    case $rest in
    \[*) host=${rest#?} host=${host%%]*} port=${rest##*]} ;;
    *:*:*) host=$rest ;;
    *) host=${rest%%:*} port=${rest#"$host"} ;;
    esac
    port=${port#:}
    [ "${port:-22}" -le 65535 ] || return 1
    case $host in *%25?*) host=${host%%%25*}%${host#*%25} ;; esac # so is a '%' written in a URI
    login=${user:+$user@}$host
    brick=$login${port:+:$port}
    case $host in *:*) brick="${user:+$user@}[$host]${port:+:$port}" ;; esac
}

# by_hand PROGRAM [OPTION...]: how a person types a program of ssh for this brick
by_hand() {
    eval "set -- \"\$@\" ${port:+-p $port} $ssh_options"
    typed "$@" "$login"
}

setting() { # setting NAME: what ssh's own settings say for this brick
    eval "set -- \"\$1\" ${port:+-p $port} $ssh_options"
    name=$1
    shift
    ssh -G "$@" -- "$login" 2>/dev/null | sed -n "s/^$name //p" | head -n 1
}

forget_key() { # forget_key WHAT_SSH_SAID: the command that has ssh forget the brick's old key
    known=$(printf '%s\n' "$1" | sed -n 's/^Offending .*key.* in \(.*\):[0-9]*$/\1/p' | head -n 1)
    as=$(setting hostkeyalias)
    if [ -z "$as" ]; then
        as=$(setting hostname)
        number=$(setting port)
        [ "$number" = 22 ] || as="[$as]:$number"
    fi
    typed ssh-keygen ${known:+-f "$known"} -R "$as"
}

remedy="is it on? Try the address on its screen (robot@192.168...) or robot@ev3dev-2.local; kickctl\
 discover lists bricks"
lost() { # lost WHAT_SSH_SAID: no connection
    printf '%s\n' "$1" >&2
    case $1 in
    *"IDENTIFICATION HAS CHANGED"*)
        remedy="a new card has a new key, and this machine remembers the old one: type\
 $(forget_key "$1"), then try again"
        ;;
    *"Host key verification failed"*)
        remedy="this machine has never met the brick: type\
 $(by_hand ssh -o StrictHostKeyChecking=ask), and say yes to its key"
        ;;
    *"Too many authentication failures"*)
        remedy="ssh offers more keys than the brick tries. Offer the right one only, or none and\
 type the password:
  $(again "-o IdentitiesOnly=yes -i KEY")
  $(again "-o PubkeyAuthentication=no")"
        ;;
    *"Permission denied"*)
        # Nobody has named a user, neither here nor in ssh's settings.
        [ -n "$user" ] || [ "$(setting user)" != "$(id -un)" ] || login=robot@$host
        remedy="an ev3dev brick's user is robot, and its password maker, unless somebody changed\
 it: $deploy robot@$host. After $(by_hand ssh-copy-id) nobody needs to type it"
        ;;
    *"Could not resolve hostname"*)
        remedy="the network knows no $host: kickctl discover lists bricks, or take the address on\
 the brick's screen: robot@192.168..."
        ;;
    esac
    fail 3 "no connection to $brick, while $doing" "$remedy"
}

again() { # again OPTIONS: how a person types this deploy with more options for ssh
    more="$1${KICK_SSH_OPTIONS:+ $KICK_SSH_OPTIONS}"
    printf 'KICK_SSH_OPTIONS=%s %s %s' "$(typed "$more")" "$deploy" "$(typed "$brick")"
}

# on_brick [-t] COMMAND: run it on the brick with this standard input. With -t it has a terminal, if
# there is one, on which it can ask for a password.
# All commands share one connection, as a new one takes seconds on a brick. It ends by itself. What
# a person's settings add to a login by hand is switched off.
on_brick() {
    terminal=-T
    if [ "$1" = -t ]; then
        shift
        [ ! -t 0 ] || terminal=-t
    fi
    : >"$folder/ssh.log" # what ssh itself says, apart from what the command says
    command=$1
    eval "set -- ${port:+-p $port} $ssh_options"
    ssh -E "$folder/ssh.log" -o ControlMaster=auto -o ControlPath="$folder/ssh" \
        -o ControlPersist=60 -o ConnectTimeout=20 -o ServerAliveInterval=5 -o LogLevel=ERROR \
        -o RemoteCommand=none -o PermitLocalCommand=no -o ClearAllForwardings=yes \
        "$terminal" "$@" -- "$login" "$command" || {
        status=$?
        case $status in
        1 | 4 | 5 | 6) return "$status" ;;
        255) lost "$(tr -d '\r' <"$folder/ssh.log")" ;;
        esac
        fail 1 "the brick's shell ended with status $status, while $doing" \
            "does $(by_hand ssh) reach a shell there?"
    }
    remedy="the brick runs whole releases only; '$deploy --status $(typed "$brick")' shows how it\
 is; then try again"
}
