#!/bin/sh
# Starts the robot's program on the brick, and says how it is: sh brick.sh run|status|logs. It needs
# a POSIX shell, coreutils, util-linux and Python, as ev3dev has them.
#
# deploy.sh sends change.sh and this script as one, with a verb of either.
#
# Below ~/kickctl:
#   releases/RELEASE    the robot's program; a folder with this name arrived whole
#   current, previous   links to the release that runs and to the one before it
#   arguments           the program's arguments, for example --left outA
#   robot.pid           the program's process id
#   robot.log           what it printed since deploy.sh last started it; robot.log.1: before that
#
# If the card cannot be written, robot.pid and robot.log are in RUN, which is in memory.
#
# Exit status: 0 done; 1 not done, and the brick is as it was; 4 the brick is not fit for it; 5 no
# robot's program is well now; 6 done, and the program is well, but the robot is in fault.
set -eu

ROOT=$HOME/kickctl
TOKEN=$HOME/.config/kickctl/token
# Where the kernel's devices, Debian's packages for Python and the system's settings are; tests set
# other places.
CLASS=${KICK_SYSFS:-/sys/class}
PACKAGES=${KICK_PACKAGES:-/usr/lib/python3/dist-packages}
ETC=${KICK_ETC:-/etc}
# shellcheck disable=SC2086 # the folders of its path, with - between them
RUN=${KICK_RUN:-/run/lock}/kickctl$(IFS=/ && set -f && set -- $HOME && IFS=- && echo "$*")
UNIT=$ETC/systemd/system/kickctl.service
AVAHI=$ETC/avahi/services/kickctl.service

IN_FAULT=3 # exit status of robot.health if the program is well, but the robot is in fault

# The connection may be gone by now; that is no reason to stop half-way.
tell() { printf '%s\n' "$*" 2>/dev/null || true; }

give_up() { # give_up STATUS WHAT REMEDY
    tell "deploy: $2"
    tell "  $3"
    exit "$1"
}

# A process more takes a brick some hundredths of a second, so the shell itself cuts texts.

# release current|previous: its name, or nothing
release() {
    to=$(readlink "$ROOT/$1" 2>/dev/null || true)
    tell "${to##*/}"
}

# kept NAME: the path of robot.pid or robot.log, wherever the last start could write them
kept() { if [ -e "$RUN/robot.pid" ]; then echo "$RUN/$1"; else echo "$ROOT/$1"; fi; }

# The program's process id; nothing if it does not run, or if another process has this number now.
program_pid() {
    { read -r pid <"$(kept robot.pid)"; } 2>/dev/null || return 0
    case $(readlink "/proc/$pid/cwd" 2>/dev/null) in
    "$(cd "$ROOT" && pwd -P)"/releases/*) echo "$pid" ;;
    esac
}

# The last one, which `sed` holds until the end.
ready() {
    sed -n '\|^READY tcp://|h; $ { x; s|^READY tcp://||p; }' "$(kept robot.log)" 2>/dev/null || true
}

port() {
    at=$(ready)
    tell "${at##*:}"
}

# Whether the program listens at one address of the brick only, by what the kernel says: arguments
# and the log have many words for it. 0A is a socket that listens, and zeros are every address.
at_one_address() {
    sockets=$(readlink "/proc/$(program_pid)/fd"/* 2>/dev/null || true)
    # Motors of an engineer's own may listen, too, at other ports.
    end=$(printf ':%04X' "$(port)" 2>/dev/null) || return 1
    cat /proc/net/tcp /proc/net/tcp6 2>/dev/null | sockets=$sockets awk -v end="$end$" '
        $4 == "0A" && $2 ~ end && $2 !~ /^0+(FFFF0+)?:/ && index(ENVIRON["sockets"], "[" $10 "]") {
            one = 1
        }
        END { exit !one }'
}

# Where on the brick the program can be reached; nothing for 127.0.0.1, as for a program that
# listens at every address. READY names the address that the brick had when that one started, and
# another day the network may give it to another robot. So 127.0.0.1 counts while nothing is known.
host() {
    at=$(ready)
    at=${at%:*} at=${at#[} at=${at%]}
    case $at in 127.0.0.1 | localhost) return ;; esac
    ! at_one_address || tell "$at"
}

# What a login may print by itself must not be taken for what deploy.sh wants to know. For each
# question to Python its own library is enough; to look for more (without -S) takes a brick 0.4 s.
address() {
    tell "kickctl-address=$(host):$(port)="
    # Releases from before it do not know it.
    tell "kickctl-hardware=$(cd "$ROOT/current" &&
        python3 -S -c 'from robot.hardware import hardware_id; print(hardware_id())' 2>/dev/null)="
}

arguments() { cat "$ROOT/arguments" 2>/dev/null || true; }

examine() { # ask the program how it is; fault becomes yes if the robot is in fault
    fault='' ill=0
    # Releases from before this question know no --host.
    host=$(host)
    health=$(cd "$ROOT/current" && python3 -S -m robot.health ${host:+--host "$host"} \
        --port "$(port)" --token "$TOKEN") || ill=$?
    tell "$health"
    [ "$ill" != "$IN_FAULT" ] || fault=yes
    [ "$ill" = 0 ] || [ -n "$fault" ]
}

run() { # run [ARGUMENT ...]: become the robot's program; robot.pid keeps its number
    cd "$ROOT/current"
    cd "$(pwd -P)" # it stays with its release, even when another becomes current
    rm -f "$RUN/robot.pid" "$RUN/robot.log"
    # The program needs no disk: neither a full card nor a closed one keeps it from starting.
    log=/dev/null
    for place in "$ROOT" "$RUN"; do
        { mkdir -p "$place" && echo $$ >"$place/robot.pid" &&
            echo "starting ${PWD##*/}" >>"$place/robot.log"; } 2>/dev/null || continue
        log=$place/robot.log
        break
    done
    # Not by -m, which takes a brick 0.4 s: for that Python imports how to look for a module. And
    # nothing that is imported is garbage; to look for some takes it 0.2 s.
    main="import gc, sys; gc.disable(); sys.path.append('$PACKAGES')
from robot.__main__ import main; raise SystemExit(main())"
    # Where Debian's packages are enough, Python itself need not look for more (-S): 0.4 s.
    alone='' given=$(arguments)
    case " $given $*" in
    *" --motors"* | *" --serial"*) ;;
    *) [ ! -d "$PACKAGES/ev3dev2" ] || alone=-S ;;
    esac
    # shellcheck disable=SC2086 # one word each
    exec python3 $alone -c "$main" --token "$TOKEN" $given "$@" >>"$log" 2>&1
}

status() {
    [ -n "$(release current)" ] || { tell "nothing was deployed here yet"; exit 5; }
    tell "release  $(release current)"
    tell "before   $(release previous)"
    service="no: deploy with --service to make it one"
    [ ! -e "$UNIT" ] || service="yes: the program starts with the brick"
    tell "service  $service"
    if [ -z "$(program_pid)" ]; then
        tell "program  does not run: deploy to start it, deploy with --logs to see its last words"
        exit 5
    fi
    listens="READY at every address of the brick, port $(port)"
    ! at_one_address || listens="READY tcp://$(ready)"
    tell "program  runs as process $(program_pid), $listens"
    state=$(examine) || ill=5
    tell "state    $state"
    [ -z "${ill-}" ] || { tell "         deploy again to end it and start a new one" && exit 5; }
}

logs() {
    log=$(kept robot.log)
    [ -e "$log" ] ||
        give_up 1 "the brick has no log" "the robot's program writes one: deploy it first"
    case $log in
    "$ROOT"/*) tell "the last lines of $log:" ;;
    *) tell "the card could not be written, so the log is in memory; the last lines of $log:" ;;
    esac
    tail -n 200 "$log"
}

# deploy.sh understands the statuses above only. A shell ends with others of its own when, for
# example, it cannot write a file.
ended() {
    status=$?
    case $status in 0 | 1 | 4 | 5 | 6) return ;; esac
    give_up 1 "the brick's shell ended with status $status" \
        "see above why; deploy with --status shows how the robot is"
}
trap ended EXIT

"$@"
