#!/bin/sh
# The brick's side of deploy.sh: sh brick.sh VERB [ARGUMENT]. It needs what ev3dev has: a POSIX shell, coreutils, util-linux, Python.
#
# Below ~/kickctl:
#   releases/RELEASE    the robot's program; what has this name arrived whole
#   current, previous   links to the release that runs and to the one before it
#   arguments           what the program is started with, such as --left outA
#   robot.log           what it said since its last start by deploy.sh; before that: robot.log.1
#
# Exit status: 0 done; 1 not done, and the brick is as it was; 4 the brick is not fit for it; 5 no robot's program is well now;
# 6 done, and the program that was started is well, but the robot is in fault.
set -eu

ROOT=$HOME/kickctl
TOKEN=$HOME/.config/kickctl/token
# Where the kernel's devices and the system's settings are; tests have them elsewhere.
CLASS=${KICK_SYSFS:-/sys/class}
ETC=${KICK_ETC:-/etc}
UNIT=$ETC/systemd/system/kickctl.service
AVAHI=$ETC/avahi/services/kickctl.service

LEAST_FREE_KB=20000
# What the brick itself warns of; writing to the card must not be cut short by an empty battery.
LEAST_LITHIUM_UV=6500000
LEAST_OTHER_UV=5500000
READY_S=60
STOP_S=5
IN_FAULT=3 # what robot.health returns of a program that is well, and whose robot is in fault

# Whoever deploys may be gone by now; that is no reason to stop half-way.
tell() { printf '%s\n' "$*" 2>/dev/null || true; }

give_up() { # give_up STATUS WHAT REMEDY
    tell "deploy: $2"
    tell "  $3"
    exit "$1"
}

only_one() {
    mkdir -p "$ROOT"
    exec 9>>"$ROOT/lock"
    flock -n 9 || give_up 1 "somebody else is deploying to this brick at this moment" "wait until they are done"
}

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

ask_password() { # before anything is touched
    as_root true || give_up 1 "a service needs the brick's administrator" "run deploy.sh at a terminal, where sudo can ask for the password"
}

release() { basename "$(readlink "$ROOT/$1" 2>/dev/null || true)"; } # release current|previous: its name, or nothing

switch() { # switch LINK RELEASE: in one step, so that the link always leads somewhere
    ln -sfn "releases/$2" "$ROOT/$1.new"
    mv -fT "$ROOT/$1.new" "$ROOT/$1"
}

program_pid() { # the program's process id; nothing if it does not run, or if the number has become somebody else's
    pid=$(cat "$ROOT/robot.pid" 2>/dev/null) || return 0
    case $(readlink "/proc/$pid/cwd" 2>/dev/null) in "$(cd "$ROOT" && pwd -P)"/releases/*) echo "$pid" ;; esac
}

port() { sed -n 's/^READY .*:\([0-9]*\)$/\1/p' "$ROOT/robot.log" 2>/dev/null | tail -n 1; }

check() { # whether this machine can run the program at all
    version=$(python3 -c 'import sys; print("%d.%d.%d" % sys.version_info[:3]); sys.exit(sys.version_info < (3, 5))' 2>/dev/null) ||
        give_up 4 "the brick's python3 is ${version:-missing}, and the robot's program needs 3.5 or newer" \
            "is this an EV3 with ev3dev-stretch? Its card has Python 3.5.3: see robot/README.md for how to write one"
    free=$(df -Pk "$HOME" | awk 'NR == 2 { print $4 }')
    [ "$free" -ge "$LEAST_FREE_KB" ] ||
        give_up 4 "the brick's card has $((free / 1000)) MB left, and $((LEAST_FREE_KB / 1000)) MB are needed" \
            "delete what is old there; 'du -ah ~ | sort -h | tail' on the brick shows what is large"
    least=$LEAST_OTHER_UV
    [ "$(cat "$CLASS/power_supply/lego-ev3-battery/technology" 2>/dev/null)" != Li-ion ] || least=$LEAST_LITHIUM_UV
    battery=$(cat "$CLASS/power_supply/lego-ev3-battery/voltage_now" 2>/dev/null || true)
    [ "${battery:-$least}" -ge "$least" ] ||
        give_up 4 "the brick's battery is low: $(volts "$battery"), and $(volts "$least") are needed" \
            "charge it, or put in fresh cells, and try again"
    tell "Python $version, $((free / 1000)) MB free, battery $(volts "$battery")"
}

volts() { [ -n "$1" ] && echo "$1" | awk '{ printf "%.2f V", $1 / 1e6 }' || echo "not measured"; }

token() { # keep what comes on standard input as the robot's token
    umask 077
    mkdir -p "${TOKEN%/*}"
    cat >"$TOKEN.new"
    [ ! -s "$TOKEN" ] || cmp -s "$TOKEN" "$TOKEN.new" ||
        tell "  the brick had another token: machines that have that one can no longer command it"
    mv -f "$TOKEN.new" "$TOKEN"
}

adopt() { # adopt RELEASE FOLDER: make a release of an upload, if it is sound
    only_one
    cd "$ROOT/releases/$2"
    sha256sum --quiet -c SHA256SUMS || discard "$2" "the upload arrived damaged" "try again; if it stays so, the card may be failing"
    python3 -m compileall -q robot || discard "$2" "the brick's Python cannot read this release" "'make lint' finds what it cannot read"
    cd ..
    sync # or a loss of power could leave empty files under a good name
    rm -rf "$1"
    mv -T "$2" "$1"
    rm -rf .incoming-*
}

discard() { # discard FOLDER WHAT REMEDY
    rm -rf "${ROOT:?}/releases/$1"
    give_up 1 "$2" "$3"
}

reset_motors() { # a motor under run-direct turns on without its program
    for command in "$CLASS"/tacho-motor/motor*/command; do
        [ ! -e "$command" ] || echo reset >"$command" || tell "deploy: $command could not be written: pull that motor's cable if it turns"
    done
}

stop_program() {
    [ ! -e "$UNIT" ] || as_root systemctl stop kickctl || true
    running=$(program_pid)
    if [ -n "$running" ]; then
        kill -TERM "$running" 2>/dev/null || true
        waited=0
        while [ -n "$(program_pid)" ] && [ "$waited" -lt $((5 * STOP_S)) ]; do
            sleep 0.2
            waited=$((waited + 1))
        done
        [ -z "$(program_pid)" ] || kill -KILL "$running" 2>/dev/null || true
    fi
    reset_motors
}

arguments() { cat "$ROOT/arguments" 2>/dev/null || true; }

keep_arguments() {
    printf '%s\n' "$1" >"$ROOT/arguments.new"
    mv -f "$ROOT/arguments.new" "$ROOT/arguments"
}

warn() { # of wheels that turn; a service begins with its motors off
    [ ! -e "$UNIT" ] || return 0
    case " $(arguments) " in
    *" --idle "*) ;;
    *) tell "The wheels will turn as soon as the program is ready: hold the robot up (with --idle among KICK_ROBOT_ARGS they do not)." ;;
    esac
}

start_program() { # start the current release and wait until it is ready and well
    warn
    rm -f "$ROOT/robot.pid"
    [ ! -e "$ROOT/robot.log" ] || mv -f "$ROOT/robot.log" "$ROOT/robot.log.1"
    if [ -e "$UNIT" ]; then
        as_root systemctl reset-failed kickctl 2>/dev/null || true # or the starts of the last minutes count
        as_root systemctl start --no-block kickctl || { tell "systemd did not start it" && return 1; }
    else
        setsid nice -n -10 sh "$ROOT/current/robot/service/brick.sh" run </dev/null >/dev/null 2>&1 9>&- &
    fi
    waited=0
    while [ -z "$(port)" ]; do
        if [ -e "$ROOT/robot.pid" ] && [ -z "$(program_pid)" ]; then
            tell "it ended before it was ready"
            return 1
        elif [ "$waited" -ge $((2 * READY_S)) ]; then
            tell "it was not ready after $READY_S s"
            return 1
        fi
        sleep 0.5
        waited=$((waited + 1))
        [ $((waited % 10)) != 0 ] || tell "  starting for $((waited / 2)) s; a brick takes 10 to 30"
    done
    examine
}

examine() { # ask the program how it is; fault becomes yes if the robot is in fault
    fault='' ill=0
    health=$(cd "$ROOT/current" && python3 -m robot.health --port "$(port)" --token "$TOKEN") || ill=$?
    tell "$health"
    [ "$ill" != "$IN_FAULT" ] || fault=yes
    [ "$ill" = 0 ] || [ -n "$fault" ]
}

done_well() { [ -z "$fault" ] || exit 6; }

install_service() {
    sed -e "s|@USER@|$(id -un)|" -e "s|@ROOT@|$ROOT|" -e "s|@CLASS@|$CLASS|" \
        "$ROOT/current/robot/service/kickctl.service" >"$ROOT/unit.new" &&
        as_root install -D -m 644 "$ROOT/unit.new" "$UNIT" &&
        as_root systemctl daemon-reload &&
        as_root systemctl enable kickctl && rm -f "$ROOT/unit.new" && return
    tell "systemd did not take the service"
    return 1
}

remove_service() { # of a program that was stopped; whatever of it is there
    rm -f "$ROOT/unit.new"
    [ ! -e "$UNIT" ] || as_root systemctl disable kickctl || true
    as_root rm -f "$UNIT" "$AVAHI"
    as_root systemctl daemon-reload || true
}

announce() { # have avahi tell the network that a robot is here; it works without
    sed -e "s|@USER@|$(id -un)|" -e "s|@PORT@|$(port)|" "$ROOT/current/robot/service/kickctl-avahi.service" >"$ROOT/avahi.new"
    as_root install -D -m 644 "$ROOT/avahi.new" "$AVAHI" || tell "  the network is not told"
    rm -f "$ROOT/avahi.new"
}

# activate RELEASE [service|'' [ARGUMENTS]]: run it from now on, as a service and with these arguments if they are given; if it is not
# well, run again what ran before, as it did.
activate() {
    only_one
    trap '' HUP INT PIPE # nobody may stop this half-way, not even by going away
    [ -d "$ROOT/releases/$1" ] || give_up 1 "there is no release $1 on the brick" "deploy it anew"
    new=$1 as=${2-}
    served=''
    [ ! -e "$UNIT" ] || served=yes
    [ -z "$as$served" ] || ask_password
    old=$(release current)
    old_arguments=$(arguments)
    tell "stopping the robot's program, resetting its motors"
    stop_program
    switch current "$new"
    [ -z "${3+given}" ] || keep_arguments "$3"
    tell "starting $new"
    if { [ -z "$as" ] || install_service; } && start_program; then
        [ "$old" = "$new" ] || [ -z "$old" ] || switch previous "$old"
        [ ! -e "$UNIT" ] || announce
        prune
        done_well
        return
    fi
    last_words
    stop_program
    [ -n "$served" ] || [ -z "$as" ] || remove_service
    go_back
}

last_words() {
    tell "the last words of its log:"
    tell "$(tail -n 15 "$ROOT/robot.log" 2>/dev/null | sed 's/^/    /')"
}

go_back() { # from activate, whose variables it uses; exits
    mend="mend what its last words say, and deploy again"
    again="$old runs again"
    failed_arguments=$(arguments)
    if [ "$failed_arguments" != "$old_arguments" ]; then
        keep_arguments "$old_arguments"
        again="$again, and with the arguments of before ('$old_arguments' instead of '$failed_arguments')"
    fi
    if [ -z "$old" ]; then
        rm -f "$ROOT/current"
        give_up 5 "release $new does not run, and there was none before it; the motors are off" "$mend"
    fi
    tell "starting $old again"
    switch current "$old"
    [ -z "$served" ] || [ -z "$as" ] || install_service || true # its own unit file, instead of that of the new one
    if start_program; then
        prune
        give_up 1 "release $new did not run; $again" "$mend"
    fi
    stop_program
    give_up 5 "neither $new nor $old runs; the motors are off" "is another program at work? The brick's log may tell: ./deploy.sh --logs"
}

prune() { # keep the release that runs and the one before
    for folder in "$ROOT"/releases/*; do
        case ${folder##*/} in "$(release current)" | "$(release previous)") ;; *) rm -rf "$folder" ;; esac
    done
}

rollback() {
    [ -n "$(release current)" ] || give_up 1 "no release is on this brick, and none to go back to" "./deploy.sh brings one"
    before=$(release previous)
    [ -n "$before" ] || give_up 1 "there is no release before this one on the brick" "check out the one that you want, and deploy it"
    activate "$before"
}

no_service() { # from now on the release runs when deploy.sh starts it
    [ -e "$UNIT" ] || [ -e "$AVAHI" ] || give_up 1 "the robot's program is no service of this brick" "so there is nothing to undo"
    only_one
    trap '' HUP INT PIPE
    ask_password
    tell "stopping the service, resetting the motors"
    stop_program
    remove_service
    tell "starting $(release current) without it"
    start_program || {
        last_words
        stop_program
        give_up 5 "the program is no service any more, but does not run; the motors are off" "./deploy.sh deploys it anew"
    }
    done_well
}

run() { # run [ARGUMENT ...]: become the robot's program; robot.pid keeps its number
    cd "$ROOT/current"
    cd "$(pwd -P)" # the release that it began with, whatever becomes current
    echo $$ >"$ROOT/robot.pid"
    # shellcheck disable=SC2046 # one word each
    exec python3 -m robot --token "$TOKEN" $(arguments) "$@" >>"$ROOT/robot.log" 2>&1
}

status() {
    [ -n "$(release current)" ] || { tell "nothing was deployed here yet"; exit 5; }
    tell "release  $(release current)"
    tell "before   $(release previous)"
    service="no: ./deploy.sh --service makes it one"
    [ ! -e "$UNIT" ] || service="yes: the program starts with the brick"
    tell "service  $service"
    if [ -z "$(program_pid)" ]; then
        tell "program  does not run: deploy.sh starts it, deploy.sh --logs tells what it said last"
        exit 5
    fi
    tell "program  runs as process $(program_pid), $(grep '^READY' "$ROOT/robot.log" | tail -n 1)"
    state=$(examine) || ill=5
    tell "state    $state"
    [ -z "${ill-}" ] || { tell "         ./deploy.sh ends it and starts it anew" && exit 5; }
}

logs() {
    [ -e "$ROOT/robot.log" ] || give_up 1 "the brick has no log" "./deploy.sh starts the robot's program there, which writes one"
    tail -n 200 "$ROOT/robot.log"
}

"$@"
