#!/bin/sh
# Brings the robot's program to a brick over ssh, starts it there and sees that it is well; ./deploy.sh --help tells the rest.
# What the brick has to do for it stands in robot/service/brick.sh.
set -eu

usage() {
    cat <<'END'
./deploy.sh [OPTION] [USER@HOST]      the brick; by default robot@ev3dev.local (password: maker)

Without an option: check the brick, copy the robot's program and the token that lets this machine command it, stop the motors and the
program that runs, start the new one and see that it is well. If it is not, the one before it runs again.

  --service    the same, and have the program start with the brick from now on, announced in the network (asks for the brick's password)
  --no-service undo that: the program no longer starts with the brick; the release stays, and runs now as after a plain ./deploy.sh
  --rollback   go back to the release before this one
  --status     tell which release is on the brick and how it is
  --logs       show what the robot's program said
  --dry-run    tell what would be done; connect to nothing
  --help       this

Unless it runs as a service, the program turns the wheels as soon as it is ready: hold the robot up, or have it started with --idle.

Environment:
  KICK_ROBOT_ARGS    what the program is started with from this deploy on, such as '--left outA --right outD --set polarity_left=-1';
                     python3 -m robot --help lists it; a release that is not well takes its arguments with it
  KICK_TOKEN         the token's file, by default ~/.config/kickctl/token; made, or fetched from the brick, if there is none
  KICK_SSH_OPTIONS   options for ssh, such as '-p 2222 -i key'

Exit status: 0 done, and the program is well, even if it reports a fault of the robot, such as a cable that is out: no other release
would mend that, and what to do is told; 1 not done, and the brick is as it was; 2 wrong use; 3 no connection; 4 the brick is not fit
(Python, space, battery); 5 no robot's program is well on the brick now.
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

quoted() { printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")"; } # one word for the brick's shell

remedy="is it on? Try the address on its screen (robot@192.168...) or robot@ev3dev-2.local; kickctl discover looks around"
lost() { # lost WHAT_SSH_SAID: no connection
    printf '%s\n' "$1" >&2
    host=${brick#*@}
    case $1 in
    *"IDENTIFICATION HAS CHANGED"*)
        remedy="a newly written card has a new key, and this machine remembers the old one: ssh-keygen -R $host, then try again"
        ;;
    *"Host key verification failed"*) remedy="make its acquaintance once: ssh $brick, and say yes to its key" ;;
    *"Permission denied"* | *"Too many authentication failures"*)
        remedy="an ev3dev brick's user is robot, with the password maker unless it was changed; ssh-copy-id robot@$host spares typing it"
        ;;
    *"Could not resolve hostname"*)
        remedy="the network knows no $host: kickctl discover looks around, or take the address on the brick's screen: robot@192.168..."
        ;;
    esac
    fail 3 "no connection to $brick, while $doing" "$remedy"
}

# One connection for everything, made by the first command; a new one costs seconds on a brick. Left alone, it ends by itself.
on_brick() { # on_brick [-t] COMMAND: run it there with this standard input, -t with a terminal if there is one, to ask for a password
    terminal=-T
    if [ "$1" = -t ]; then
        shift
        [ ! -t 0 ] || terminal=-t
    fi
    : >"$folder/ssh.log" # what ssh itself says, apart from what the command says
    # shellcheck disable=SC2086 # options are words
    ssh -E "$folder/ssh.log" -o ControlMaster=auto -o ControlPath="$folder/ssh" -o ControlPersist=60 -o ConnectTimeout=20 \
        -o ServerAliveInterval=5 -o LogLevel=ERROR "$terminal" ${KICK_SSH_OPTIONS-} -- "$brick" "$1" || {
        status=$?
        [ "$status" != 255 ] || lost "$(tr -d '\r' <"$folder/ssh.log")"
        return "$status"
    }
    remedy="no half-done release ever runs there; './deploy.sh --status $brick' tells how it is; then try again"
}

leave() {
    [ ! -e "$folder/ssh" ] || ssh -o ControlPath="$folder/ssh" -O exit -- "$brick" 2>/dev/null || true
    rm -rf "$folder"
}

dry_run() {
    case $verb in
    status | logs) say "would connect to $brick and show its $verb" ;;
    rollback)
        say "would connect to $brick, stop the robot's program, reset its motors, and start the release before, if there is one"
        wheels
        ;;
    no-service)
        say "would connect to $brick, stop the robot's program, reset its motors, and remove the service and its announcement"
        say "  start the same release without it"
        wheels
        ;;
    deploy)
        say "would deploy release $id to $brick:"
        say "  check there: Python 3.5 or newer, 20 MB of space, battery"
        say "  copy to ~/kickctl/releases/$id, check every file's sum, and compile:"
        sed 's/^[0-9a-f]*  /    /' "$folder/SHA256SUMS"
        if [ -e "$token" ]; then say "  copy the token $token"; else say "  fetch the brick's token, or make one, as $token"; fi
        [ -z "${KICK_ROBOT_ARGS+set}" ] || say "  start the program from now on with: $KICK_ROBOT_ARGS"
        say "  stop the robot's program (SIGTERM, after 5 s SIGKILL), reset all motors"
        say "  make $id the current release${service:+ and have systemd start it with the brick}"
        say "  start it, wait up to 60 s until it is ready, ask it how it is; if it is not well, start the release before again"
        [ -n "$service" ] || wheels
        ;;
    esac
}

wheels() { say "  the wheels turn then, unless it is started with --idle, as a service always is"; }

give_token() { # both must have the same; one that the brick has already may be in use by other machines
    if [ ! -e "$token" ]; then
        theirs=$(on_brick "cat .config/kickctl/token 2>/dev/null || true" </dev/null)
        if [ -n "$theirs" ]; then
            step "fetching the brick's token as $token"
            (umask 077 && mkdir -p "$(dirname "$token")" && printf '%s\n' "$theirs" >"$token")
        fi
    fi
    made=$(python3 -B -c '
import sys
from robot import token
try:
    print("" if token.load_or_make(sys.argv[1])[1] else "there")
except token.TokenError as error:
    sys.exit(str(error))' "$token" 2>&1) || fail 1 "$made" "mend that file, or delete it to have a new one made, and deploy again"
    [ -n "$made" ] || step "making a token"
    step "copying the token $token"
    on_brick "sh $files/robot/service/brick.sh token" <"$token"
}

upload() {
    files=kickctl/releases/$id
    if on_brick "cd $files 2>/dev/null && sha256sum --quiet -c SHA256SUMS >/dev/null 2>&1" </dev/null; then
        step "release $id is there already"
        return
    fi
    step "copying release $id"
    incoming=.incoming-$id-$$
    there=kickctl/releases/$incoming
    tar -cz robot/*.py robot/service/* -C "$folder" SHA256SUMS |
        on_brick "mkdir -p $there && tar -xzmC $there || { rm -rf $there; exit 1; }" || {
        [ $? != 3 ] || exit 3
        fail 1 "the copy did not arrive whole; what runs on the brick is untouched" "is its card full, or failing? Try again"
    }
    step "checking and compiling it there"
    on_brick "sh $there/robot/service/brick.sh adopt $id $incoming" </dev/null
}

deploy() {
    on_brick "sh -s check" <robot/service/brick.sh
    upload
    give_token
    step "changing over to $id"
    change_over "sh $files/robot/service/brick.sh activate $id '$service' ${KICK_ROBOT_ARGS+$(quoted "$KICK_ROBOT_ARGS")}"
}

# With this script and not with that of the release there, which may be an older one, or none at all; not through standard input, which
# sudo may need to ask for a password.
by_this_script() { change_over "sh -c $(quoted "$(cat robot/service/brick.sh)") brick.sh $1"; }

change_over() { # change_over COMMAND: which starts a release on the brick; then tell how to go on
    fault=''
    on_brick -t "$1" || {
        status=$?
        [ "$status" = 6 ] || exit "$status"
        fault=yes
    }
    kickctl=kickctl
    command -v kickctl >/dev/null || kickctl=$here/.venv/bin/kickctl
    say
    if [ -n "$fault" ]; then
        say "The robot's program runs on $brick, but the robot is in fault, as told above. Mend that, clear the fault, let it run:"
        say "  $kickctl --brick ssh://$brick clear"
        say "  $kickctl --brick ssh://$brick start"
    else
        say "The robot's program runs on $brick. Let it run, kick it, stop it:"
        say "  $kickctl --brick ssh://$brick start"
        say "  $kickctl --brick ssh://$brick kick --mode phase --ticks 4"
        say "  $kickctl --brick ssh://$brick stop"
    fi
    [ "$kickctl" = kickctl ] || [ -x .venv/bin/kickctl ] || say "There is no kickctl yet: make setup makes it."
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
    -*) fail 2 "there is no option $argument" "./deploy.sh --help lists them" ;;
    '') fail 2 "the brick's name is empty" "give it as USER@HOST, or leave it out for $brick" ;;
    *)
        [ -z "$named" ] || fail 2 "two bricks: $brick and $argument" "deploy to one after the other"
        brick=$argument named=yes
        ;;
    esac
done
[ -z "$service" ] || [ "$verb" = deploy ] || fail 2 "--service and --$verb at once" "give one of them"

token=${KICK_TOKEN:-${XDG_CONFIG_HOME:-$HOME/.config}/kickctl/token}
case $token in /*) ;; *) token=$PWD/$token ;; esac
here=$(dirname "$0")
cd "$here"
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
