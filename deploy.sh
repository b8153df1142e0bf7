#!/bin/sh
# Brings the robot's program to a brick over ssh, starts it there and checks that it is well: --help
# says how. robot/service/brick.sh does the brick's part of the work.
set -eu

say() { printf '%s\n' "$*"; }
step() {
    doing=$*
    say "==> $*"
}
fail() { # fail STATUS WHAT REMEDY
    printf 'deploy: %s\n  %s\n' "$2" "$3" >&2
    exit "$1"
}

# quoted TEXT: as one word for a shell
quoted() { printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")"; }

typed() { # typed WORD...: a command as a person types it, quoted where that is needed
    line=''
    for word; do
        case $word in
        '' | *[!A-Za-z0-9_./:@%+=,-]*) word=$(quoted "$word") ;;
        esac
        line="$line $word"
    done
    printf '%s' "${line# }"
}

# What a person types for this script; `kickctl deploy` runs it with KICKCTL set.
case $0 in */*) deploy=$(typed "$0") ;; *) deploy=./$(typed "$0") ;; esac
[ -z "${KICKCTL-}" ] || deploy="$KICKCTL deploy"

usage() {
    cat <<END
$deploy [OPTION] [BRICK]    the brick, by default robot@ev3dev.local (password: maker)

BRICK is USER@HOST, HOST (also a name of ~/.ssh/config), or ssh://USER@HOST:PORT, where PORT is the
port of ssh. An IPv6 address before a port stands in brackets.

Without an option: check the brick, copy the robot's program and the token that lets this machine
command it, stop the program that runs and its motors, start the new one and check that it is well.
If it is not, the one before it runs again.

END
    cat <<'END'
  --service     the same; from now on the program starts with the brick, and announces itself in
                the network (asks for the brick's password)
  --no-service  undo that: from now on the program starts only when it is deployed
  --rollback    go back to the release before this one
  --status      show which release is on the brick, and how it is
  --logs        show what the robot's program printed
  --dry-run     show what would be done; connect to nothing
  --help        show this

The wheels turn as soon as the program is ready, unless it runs as a service: hold the robot up, or
start the program with --idle.

Environment:
  KICK_ROBOT_ARGS    arguments of the robot's program, from this deploy on; for example
                     '--left outA --right outD --set polarity_left=-1'.
                     python3 -m robot --help lists them. If the new release is not well, the
                     arguments of before count again
  KICK_TOKEN         the token's file, by default ~/.config/kickctl/token; if there is none, the
                     brick's is fetched, or a new one is made
  KICK_SSH_OPTIONS   options for ssh, for example '-p 2222 -i "my key"', quoted as for a shell

Exit status: 0 done, and the program is well. It may still report a fault of the robot, such as a
cable that is out: another release would not help, and the output says what does. 1 not done, and
the brick is as it was; 2 wrong use; 3 no connection; 4 the brick is not fit (Python, card,
battery); 5 no robot's program is well on the brick now.
END
}

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
    host=$(printf '%s' "$host" | sed 's/%25\(.\)/%\1/') # so is a '%' written in a URI
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

# marked NAME: what brick.sh has printed under this name, among all that a login may print
marked() { sed -n "s/.*kickctl-$1=\([^=]*\)=.*/\1/p" | tail -n 1; }

is_token() { # is_token TEXT: 32 bytes in hexadecimal
    case $1 in *[!0-9A-Fa-f]*) return 1 ;; esac
    [ "${#1}" = 64 ]
}

leave() {
    [ ! -e "$folder/ssh" ] ||
        ssh -o ControlPath="$folder/ssh" -O exit -- "$login" 2>/dev/null || true
    rm -rf "$folder"
}

dry_run() {
    case $verb in
    status | logs) say "would connect to $brick and show its $verb" ;;
    rollback)
        say "would connect to $brick, stop the robot's program and its motors"
        say "  start the release before this one, if there is one"
        wheels
        ;;
    no-service)
        say "would connect to $brick, stop the robot's program and its motors"
        say "  remove the service and its announcement, and start the same release without it"
        wheels
        ;;
    deploy)
        say "would deploy release $id to $brick:"
        say "  check there: Python 3.5 or newer, 20 MB of space, battery"
        say "  copy to ~/kickctl/releases/$id, compare every file's checksum, and compile:"
        sed 's/^[0-9a-f]*  /    /' "$folder/SHA256SUMS"
        if [ -e "$token" ]; then
            say "  copy the token $token"
        else
            say "  fetch the brick's token, or make one, as $token"
        fi
        [ -z "${KICK_ROBOT_ARGS+set}" ] ||
            say "  start the program from now on with: $KICK_ROBOT_ARGS"
        say "  stop the robot's program (SIGTERM, after 5 s SIGKILL), reset all motors"
        say "  make $id the current release${service:+ and have systemd start it with the brick}"
        say "  start it, wait up to 60 s until it is ready, and ask it how it is"
        say "  if it is not well, start the release before it again"
        [ -n "$service" ] || wheels
        ;;
    esac
}

wheels() { say "  the wheels turn then, unless it starts with --idle, as a service always does"; }

# Both sides need the same token. Other machines may use one that the brick has already.
give_token() {
    if [ ! -e "$token" ]; then
        on_brick "sh -s show_token" <robot/service/brick.sh >"$folder/answer" || {
            status=$?
            sed 's/^/  /' "$folder/answer"
            exit "$status"
        }
        theirs=$(marked token <"$folder/answer")
        if is_token "$theirs"; then
            step "fetching the brick's token as $token"
            (umask 077 && mkdir -p "$(dirname "$token")" && printf '%s\n' "$theirs" >"$token.new" &&
                mv "$token.new" "$token") ||
                fail 1 "the token file $token cannot be written" "see why, and deploy again"
        elif [ "$theirs" != none ]; then
            fail 1 "the brick did not say whether it has a token" \
                "see what $(by_hand ssh) prints there, and mend that"
        fi
    fi
    [ -e "$token" ] || step "making a token"
    ours=$(python3 -B -c '
import sys
from robot import token
try:
    token.load_or_make(sys.argv[1])
except token.TokenError as error:
    sys.exit(str(error))' "$token" 2>&1) ||
        fail 1 "$ours" "that file is on this machine: mend it, or delete it to get a new one"
    step "copying the token $token"
    on_brick "sh $files/robot/service/brick.sh token" <"$token"
}

upload() {
    files=kickctl/releases/$id
    whole="{ cd $files && sha256sum --quiet -c SHA256SUMS; } >/dev/null 2>&1 || exit 1"
    if on_brick "$whole" </dev/null; then
        step "release $id is there already"
        return
    fi
    step "copying release $id"
    incoming=.incoming-$id-$$
    there=kickctl/releases/$incoming
    tar -cz robot/*.py robot/service/* -C "$folder" SHA256SUMS |
        on_brick "mkdir -p $there && tar -xzmC $there || { rm -rf $there; exit 1; }" || {
        [ $? != 3 ] || exit 3
        fail 1 "the copy did not arrive whole; the brick runs on as before" \
            "is its card full, or failing? Try again"
    }
    step "checking and compiling it there"
    on_brick "sh $there/robot/service/brick.sh adopt $id $incoming" </dev/null
}

deploy() {
    on_brick "sh -s check" <robot/service/brick.sh
    upload
    give_token
    step "starting $id instead of what runs now"
    arguments=${KICK_ROBOT_ARGS+$(quoted "$KICK_ROBOT_ARGS")}
    change_over "sh $files/robot/service/brick.sh activate $id '$service' $arguments"
}

# by_this_script VERB: with the brick.sh of this machine, as the release on the brick may be older,
# or missing. Not through standard input: sudo may need that to ask for a password.
by_this_script() { change_over "sh -c $(quoted "$(cat robot/service/brick.sh)") brick.sh $1"; }

# change_over COMMAND: run it on the brick, where it starts a release; then say how to go on
change_over() {
    fault=''
    on_brick -t "$1" || {
        status=$?
        [ "$status" = 6 ] || exit "$status"
        fault=yes
    }
    # It is done, even if the connection is lost now.
    (on_brick "sh -s address") <robot/service/brick.sh >"$folder/answer" 2>/dev/null || true
    say
    if [ -n "$fault" ]; then
        say "The program runs on $brick, but the robot is in fault: see above. Mend that, then:"
        commands "clear" "start"
    else
        say "The robot's program runs on $brick. Start the robot, kick it, stop it:"
        commands "start" "kick --mode phase --ticks 4" "stop"
    fi
}

# commands VERB...: how a person types kickctl for this robot
commands() {
    kickctl=kickctl
    command -v kickctl >/dev/null || kickctl=${KICKCTL-$(typed "$from/.venv/bin/kickctl")}
    with=''
    [ -z "${KICK_SSH_OPTIONS-}" ] || with="KICK_SSH_OPTIONS=$(typed "$KICK_SSH_OPTIONS") "
    [ -z "${KICK_TOKEN-}" ] || with="${with}KICK_TOKEN=$(typed "$token") "
    for words; do
        say "  $with$kickctl --brick $(typed "ssh://$brick$(listens)") $words"
    done
    [ -n "${KICKCTL-}" ] || [ "$kickctl" = kickctl ] || [ -x .venv/bin/kickctl ] ||
        say "There is no kickctl yet: type $(typed cd "$from") && make setup"
}

# Where on the brick the robot's program listens, as the end of a robot's address; nothing if it is
# where kickctl looks.
listens() {
    at=$(marked address <"$folder/answer")
    number=${at##*:} at=${at%:*}
    case $number in '' | *[!0-9]*) return ;; esac
    case $at in
    0.0.0.0 | 127.0.0.1 | localhost | *[!0-9A-Za-z:.%_-]*) at='' ;;
    ::) at=::1 ;;
    esac
    [ -z "$at" ] || printf '?host=%s&port=%s' "$(printf '%s' "$at" | sed s/%/%25/)" "$number"
    [ -n "$at" ] || [ "$number" = 5425 ] || printf '?port=%s' "$number"
}

verb=deploy service='' dry='' named=''
for argument; do
    case $argument in
    --help | -h) usage && exit 0 ;;
    --dry-run) dry=yes ;;
    --service) service=service ;;
    --no-service | --rollback | --status | --logs)
        [ "$verb" = deploy ] || fail 2 "--$verb and $argument at once" "give one of them"
        verb=${argument#--}
        ;;
    -*) fail 2 "there is no option $argument" "$deploy --help lists them" ;;
    *)
        [ -z "$named" ] || fail 2 "two bricks: $named and $argument" "deploy to one after the other"
        address "$argument" || fail 2 "'$argument' is no address of a brick" \
            "write USER@HOST or ssh://USER@HOST:PORT, or leave it out for robot@ev3dev.local"
        named=$argument
        ;;
    esac
done
[ -n "$named" ] || address robot@ev3dev.local
[ -z "$service" ] || [ "$verb" = deploy ] ||
    fail 2 "--service and --$verb at once" "give one of them"

token=${KICK_TOKEN:-${XDG_CONFIG_HOME:-${HOME:-\~}/.config}/kickctl/token}
case $token in
\~*) fail 2 "there is no home folder for the token file $token" \
    "name a file by its whole path in KICK_TOKEN" ;;
/*) ;;
*) token=$PWD/$token ;;
esac
from=$(dirname "$0") # as it was typed, so that the closing words can be typed too
# In a checkout robot/ lies beside this script; in an installed kickctl it lies one folder higher.
cd "$(dirname "$(readlink -f "$0")")"
[ -d robot ] || cd ..
command -v python3 >/dev/null || fail 2 "this machine has no python3" "install it; kickctl needs it"
# By the rules of host/link/ssh.py, as words of this shell.
ssh_options=$(python3 -B -c '
import os, shlex
try:
    print(*map(shlex.quote, shlex.split(os.environ.get("KICK_SSH_OPTIONS", ""))))
except ValueError as error:
    raise SystemExit(str(error))' 2>&1) ||
    fail 2 "KICK_SSH_OPTIONS cannot be understood: $ssh_options" "close its quotes"
# In /tmp even if TMPDIR is set: ssh needs a short and plain path for the connection that it shares.
folder=$(mktemp -d /tmp/kickctl.XXXXXX) ||
    fail 1 "nothing can be written to /tmp" "is this machine's disk full? Mend that, and try again"
trap leave EXIT
trap 'exit 130' HUP INT TERM
version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' robot/__init__.py)
sha256sum robot/*.py robot/service/* >"$folder/SHA256SUMS"
id=$version-$(sha256sum <"$folder/SHA256SUMS" | cut -c 1-10)

if [ -n "$dry" ]; then
    dry_run
    exit 0
fi
step "connecting to $brick"
case $verb in
deploy) deploy ;;
rollback) by_this_script rollback ;;
no-service) by_this_script no_service ;;
*) on_brick "sh -s $verb" <robot/service/brick.sh ;;
esac
