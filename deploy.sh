#!/bin/sh
# Brings the robot's program to a brick over ssh, starts it there and checks that it is well: --help
# says how. robot/service/ has the brick's part of the work.
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
quoted() {
    case $1 in
    *\'*) printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")" ;;
    *) printf "'%s'" "$1" ;;
    esac
}

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
  KICK_AS            the robot's name on this machine, by default that of its machine
  KICK_TOKEN         the token's file, by default ~/.config/kickctl/tokens/NAME if it is there, or
                     ~/.config/kickctl/token; if there is none, the brick's is fetched, or a new
                     one is made
  KICK_SSH_OPTIONS   options for ssh, for example '-p 2222 -i "my key"', quoted as for a shell

Exit status: 0 done, and the program is well. It may still report a fault of the robot, such as a
cable that is out: another release would not help, and the output says what does. 1 not done, and
the brick is as it was; 2 wrong use; 3 no connection; 4 the brick is not fit (Python, card,
battery); 5 no robot's program is well on the brick now.
END
}

# marked NAME: what brick.sh has printed under this name, among all that a login may print
marked() {
    sed -n "/kickctl-$1=[^=]*=/h; $ { x; s/.*kickctl-$1=\([^=]*\)=.*/\1/p; }"
}

leave() {
    [ ! -e "$folder/ssh" ] ||
        ssh -o ControlPath="$folder/ssh" -O exit -- "$login" 2>/dev/null || true
    rm -rf "$folder"
}

dry_run() {
    case $verb in
    status | logs) say "would connect to $brick and show its $verb" && return ;;
    rollback) say "would connect to $brick and go back to the release before, if there is one:" ;;
    no-service) say "would connect to $brick and remove the service and its announcement:" ;;
    deploy)
        say "would deploy release $id to $brick:"
        say "  check there: Python 3.5 or newer, 20 MB of space, battery"
        say "  copy to ~/kickctl/releases/$id, compare every file's checksum, and compile:"
        sed 's/^[0-9a-f]*  /    /' "$folder/SHA256SUMS"
        [ -e "$token" ] || say "  fetch the brick's token, or make one"
        say "  copy the token $token"
        [ -z "${KICK_ROBOT_ARGS+set}" ] ||
            say "  start the program from now on with: $KICK_ROBOT_ARGS"
        ;;
    esac
    say "  stop the robot's program (SIGTERM, after 5 s SIGKILL), reset all motors"
    say "  start it${service:+ as a service}, wait up to 60 s until it is ready, ask it how it is"
    [ "$verb" = no-service ] || say "  if it is not well, start the release before it again"
    [ -n "$service" ] ||
        say "  the wheels turn then, unless it starts with --idle, as a service always does"
}

# The brick runs the scripts of this machine, as those there may be older, or missing.
# ask VERB [ARGUMENT...]: have the brick do it
ask() { on_brick "sh -s $*" <"$folder/brick.sh"; }

# script VERB [ARGUMENT...]: the command for a verb that needs standard input itself
script() { printf 'sh -c %s brick.sh %s' "$(quoted "$(cat "$folder/brick.sh")")" "$*"; }

# Both sides need the same token. Other machines may use one that the brick has already.
give_token() {
    if [ ! -e "$token" ]; then
        ask show_token >"$folder/answer" || {
            status=$?
            sed 's/^/  /' "$folder/answer"
            exit "$status"
        }
        theirs=$(marked token <"$folder/answer")
        if printf '%s' "$theirs" | grep -Eqx '[0-9A-Fa-f]{64}'; then # 32 bytes
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
    ours=$(python3 -BS -c '
import sys
from robot import token
try:
    token.load_or_make(sys.argv[1])
except token.TokenError as error:
    sys.exit(str(error))' "$token" 2>&1) ||
        fail 1 "$ours" "that file is on this machine: mend it, or delete it to get a new one"
    step "copying the token $token"
    on_brick "$(script token)" <"$token"
}

upload() {
    if ask has "$id"; then
        step "release $id is there already"
        return
    fi
    step "copying release $id"
    incoming=.incoming-$id-$$ there=kickctl/releases/.incoming-$id-$$
    tar -cz robot/*.py robot/service/* -C "$folder" SHA256SUMS |
        on_brick "mkdir -p $there && tar -xzmC $there || { rm -rf $there; exit 1; }" || {
        [ $? != 3 ] || exit 3
        fail 1 "the copy did not arrive whole; the brick runs on as before" \
            "is its card full, or failing? Try again"
    }
    step "checking and compiling it there"
    ask adopt "$id" "$incoming"
}

deploy() {
    ask check
    upload
    give_token
    step "starting $id instead of what runs now"
    arguments=${KICK_ROBOT_ARGS+$(quoted "$KICK_ROBOT_ARGS")}
    change_over activate "$id" "'$service'" "$arguments"
}

# change_over VERB [ARGUMENT...]: do what starts a release, then say how to go on. sudo may ask for
# a password meanwhile.
change_over() {
    fault=''
    on_brick -t "$(script "$@")" || {
        status=$?
        [ "$status" = 6 ] || exit "$status"
        fault=yes
    }
    # It is done, even if the connection is lost now.
    (ask address) >"$folder/answer" 2>/dev/null || true
    where=ssh://$brick$(listens) kickctl=kickctl
    command -v kickctl >/dev/null || kickctl=${KICKCTL-$(typed "$from/.venv/bin/kickctl")}
    say
    remember
    if [ -n "$fault" ]; then
        say "The program runs on $brick, but the robot is in fault: see above. Mend that, then:"
        commands "clear" "start"
    else
        say "The robot's program runs on $brick. Start the robot, kick it, stop it:"
        commands "start" "kick --mode phase --ticks 4" "stop"
    fi
}

# Give the robot a name on this machine, by which kickctl finds its address and its token. Without a
# kickctl, say how.
remember() {
    called='' run=${KICKCTL-}
    [ -n "$run" ] || ! command -v kickctl >/dev/null || run=kickctl
    hardware=$(marked hardware <"$folder/answer" | grep -Ex '[0-9a-f]{32}' || true)
    if [ -z "$run" ]; then
        say "To give the robot a name: $kickctl $(adding "$where")"
    elif add "$where" || { has_old_address && add "$old" && add "$where"; }; then
        # A robot that is known by its hardware id keeps its name.
        called=$(sed -n 's/^\([A-Za-z0-9_-]*\) is .*/\1/p' "$folder/answer" | tail -n 1)
        called=${called:-$name}
        [ "$called" = "$name" ] || sed -n '/^its hardware id/p' "$folder/answer"
        say "The robot is known here as $called: kickctl robots list"
    else
        say "The robot got no name here:"
        sed 's/^/  /' "$folder/answer"
    fi
}

adding() { printf 'robots add %s --token %s' "$(typed "$name" "$1")" "$(typed "$token")"; }

# add ADDRESS: keep it under the robot's name
add() { eval "$run $(adding "$1") ${hardware:+--hardware-id $hardware}" >"$folder/answer" 2>&1; }

# Whether the name has an address with ?host= of this brick, which may be another robot's by now. If
# it has no hardware id yet, nothing else shows that both are one robot: it gets the id there first.
has_old_address() {
    old=$(eval "$run robots list" 2>/dev/null | awk -v name="$name" '$1 == name { print $2 }')
    case $old in "ssh://$brick?host="*) ;; *) return 1 ;; esac
}

# commands VERB...: how a person types kickctl for this robot
commands() {
    with=''
    [ -z "${KICK_SSH_OPTIONS-}" ] || with="KICK_SSH_OPTIONS=$(typed "$KICK_SSH_OPTIONS") "
    [ -n "$called" ] || [ -z "${KICK_TOKEN-}" ] || with="${with}KICK_TOKEN=$(typed "$token") "
    for words; do
        say "  $with$kickctl --brick $(typed "${called:-$where}") $words"
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
    case $at in *[!0-9A-Za-z:.%_-]*) at='' ;; esac
    [ -z "$at" ] || printf '?host=%s&port=%s' "$(printf '%s' "$at" | sed s/%/%25/)" "$number"
    [ -n "$at" ] || [ "$number" = 5425 ] || printf '?port=%s' "$number"
}

here=$PWD
from=$(dirname "$0") # as it was typed, so that the closing words can be typed too
# In a checkout robot/ lies beside this script; in an installed kickctl it lies one folder higher.
self=$(readlink -f "$0")
cd "${self%/*}/"
[ -d robot ] || cd ..
. host/deploy/ssh.sh

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

# The robot's name on this machine: its machine's, if nobody has given another one.
name=${KICK_AS:-$(printf '%s' "${host%.local}" | tr -c 'A-Za-z0-9_-' '-')}
config=${XDG_CONFIG_HOME:-${HOME:-\~}/.config}/kickctl
token=${KICK_TOKEN:-$config/tokens/$name}
# Without a kickctl that keeps names, robots share a token, but for those that have their own.
[ -n "${KICK_TOKEN-}${KICKCTL-}" ] || [ -e "$token" ] || token=$config/token
case $token in
\~*) fail 2 "there is no home folder for the token file $token" \
    "name a file by its whole path in KICK_TOKEN" ;;
/*) ;;
*) token=$here/$token ;;
esac
command -v python3 >/dev/null || fail 2 "this machine has no python3" "install it; kickctl needs it"
# By the rules of host/link/ssh.py, as words of this shell; plain words are that already.
ssh_options=${KICK_SSH_OPTIONS-}
case $ssh_options in *[!A-Za-z0-9_./:@%+=,\ -]*)
    ssh_options=$(python3 -BS -c '
import os, shlex
try:
    print(*map(shlex.quote, shlex.split(os.environ["KICK_SSH_OPTIONS"])))
except ValueError as error:
    raise SystemExit(str(error))' 2>&1) ||
        fail 2 "KICK_SSH_OPTIONS cannot be understood: $ssh_options" "close its quotes"
    ;;
esac
# In /tmp even if TMPDIR is set: ssh needs a short and plain path for the connection that it shares.
folder=$(mktemp -d /tmp/kickctl.XXXXXX) ||
    fail 1 "nothing can be written to /tmp" "is this machine's disk full? Mend that, and try again"
trap leave EXIT
trap 'exit 130' HUP INT TERM
version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' robot/__init__.py)
cat robot/service/change.sh robot/service/brick.sh >"$folder/brick.sh"
sha256sum robot/*.py robot/service/* >"$folder/SHA256SUMS"
id=$version-$(sha256sum <"$folder/SHA256SUMS" | cut -c 1-10)

if [ -n "$dry" ]; then
    dry_run
    exit 0
fi
step "connecting to $brick"
case $verb in
deploy) deploy ;;
rollback) change_over rollback ;;
no-service) change_over no_service ;;
*) ask "$verb" ;;
esac
