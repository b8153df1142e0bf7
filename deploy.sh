#!/bin/sh
# Brings the robot's program to a brick over ssh, starts it there and checks that it is well: --help
# says how. robot/service/brick.sh does the brick's part of the work.
set -eu

# What a person types for kickctl and for this script; `kickctl deploy` runs it with KICKCTL set.
deploy=./deploy.sh
[ -z "${KICKCTL-}" ] || deploy="$KICKCTL deploy"

usage() {
    cat <<END
$deploy [OPTION] [USER@HOST]    the brick, by default robot@ev3dev.local (password: maker)

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
  KICK_SSH_OPTIONS   options for ssh, for example '-p 2222 -i key'

Exit status: 0 done, and the program is well. It may still report a fault of the robot, such as a
cable that is out: another release would not help, and the output says what does. 1 not done, and
the brick is as it was; 2 wrong use; 3 no connection; 4 the brick is not fit (Python, space,
battery); 5 no robot's program is well on the brick now.
END
}

say() { printf '%s\n' "$*"; }
step() {
    doing=$*
    say "==> $*"
}
fail() { # fail STATUS WHAT REMEDY
    printf 'deploy: %s\n  %s\n' "$2" "$3" >&2
    exit "$1"
}

# quoted TEXT: as one word for the brick's shell
quoted() { printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")"; }

remedy="is it on? Try the address on its screen (robot@192.168...) or robot@ev3dev-2.local; kickctl\
 discover lists bricks"
lost() { # lost WHAT_SSH_SAID: no connection
    printf '%s\n' "$1" >&2
    host=${brick#*@}
    case $1 in
    *"IDENTIFICATION HAS CHANGED"*)
        remedy="a new card has a new key, and this machine remembers the old one: type\
 ssh-keygen -R $host, then try again"
        ;;
    *"Host key verification failed"*)
        remedy="this machine has never met the brick: type ssh $brick, and say yes to its key"
        ;;
    *"Permission denied"* | *"Too many authentication failures"*)
        remedy="an ev3dev brick's user is robot, and its password maker, unless somebody changed\
 it; after ssh-copy-id robot@$host nobody needs to type it"
        ;;
    *"Could not resolve hostname"*)
        remedy="the network knows no $host: kickctl discover lists bricks, or take the address on\
 the brick's screen: robot@192.168..."
        ;;
    esac
    fail 3 "no connection to $brick, while $doing" "$remedy"
}

# on_brick [-t] COMMAND: run it on the brick with this standard input. With -t it has a terminal, if
# there is one, on which it can ask for a password.
# All commands share one connection, as a new one takes seconds on a brick. It ends by itself.
on_brick() {
    terminal=-T
    if [ "$1" = -t ]; then
        shift
        [ ! -t 0 ] || terminal=-t
    fi
    : >"$folder/ssh.log" # what ssh itself says, apart from what the command says
    # shellcheck disable=SC2086 # options are words
    ssh -E "$folder/ssh.log" -o ControlMaster=auto -o ControlPath="$folder/ssh" \
        -o ControlPersist=60 -o ConnectTimeout=20 -o ServerAliveInterval=5 -o LogLevel=ERROR \
        "$terminal" ${KICK_SSH_OPTIONS-} -- "$brick" "$1" || {
        status=$?
        [ "$status" != 255 ] || lost "$(tr -d '\r' <"$folder/ssh.log")"
        return "$status"
    }
    remedy="the brick runs whole releases only; '$deploy --status $brick' shows how it is; then try\
 again"
}

leave() {
    [ ! -e "$folder/ssh" ] ||
        ssh -o ControlPath="$folder/ssh" -O exit -- "$brick" 2>/dev/null || true
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
        theirs=$(on_brick "cat .config/kickctl/token 2>/dev/null || true" </dev/null)
        if [ -n "$theirs" ]; then
            step "fetching the brick's token as $token"
            (umask 077 && mkdir -p "$(dirname "$token")" && printf '%s\n' "$theirs" >"$token")
        fi
    fi
    found=$(python3 -B -c '
import sys
from robot import token
try:
    print("" if token.load_or_make(sys.argv[1])[1] else "there")
except token.TokenError as error:
    sys.exit(str(error))' "$token" 2>&1) ||
        fail 1 "$found" "mend that file, or delete it to get a new one; then deploy again"
    [ -n "$found" ] || step "making a token"
    step "copying the token $token"
    on_brick "sh $files/robot/service/brick.sh token" <"$token"
}

upload() {
    files=kickctl/releases/$id
    whole="cd $files 2>/dev/null && sha256sum --quiet -c SHA256SUMS >/dev/null 2>&1"
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
    kickctl=kickctl
    command -v kickctl >/dev/null || kickctl=${KICKCTL-$from/.venv/bin/kickctl}
    say
    if [ -n "$fault" ]; then
        say "The program runs on $brick, but the robot is in fault: see above. Mend that, then:"
        say "  $kickctl --brick ssh://$brick clear"
        say "  $kickctl --brick ssh://$brick start"
    else
        say "The robot's program runs on $brick. Start the robot, kick it, stop it:"
        say "  $kickctl --brick ssh://$brick start"
        say "  $kickctl --brick ssh://$brick kick --mode phase --ticks 4"
        say "  $kickctl --brick ssh://$brick stop"
    fi
    [ "$kickctl" != "$from/.venv/bin/kickctl" ] || [ -x .venv/bin/kickctl ] ||
        say "There is no kickctl yet: make setup installs it."
}

verb=deploy service='' dry='' brick=robot@ev3dev.local named=''
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
    '') fail 2 "the brick's name is empty" "give it as USER@HOST, or leave it out for $brick" ;;
    *)
        [ -z "$named" ] || fail 2 "two bricks: $brick and $argument" "deploy to one after the other"
        brick=$argument named=yes
        ;;
    esac
done
[ -z "$service" ] || [ "$verb" = deploy ] ||
    fail 2 "--service and --$verb at once" "give one of them"

token=${KICK_TOKEN:-${XDG_CONFIG_HOME:-$HOME/.config}/kickctl/token}
case $token in /*) ;; *) token=$PWD/$token ;; esac
from=$(dirname "$0") # as it was typed, so that the closing words can be typed too
# In a checkout robot/ lies beside this script; in an installed kickctl it lies one folder higher.
cd "$(dirname "$(readlink -f "$0")")"
[ -d robot ] || cd ..
folder=$(mktemp -d)
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
