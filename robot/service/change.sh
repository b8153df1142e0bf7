#!/bin/sh
# Changes the release that the brick has and runs: the functions of deploy.sh's verbs. deploy.sh
# sends it with brick.sh behind it, which has what they share, and which calls the verb.

LEAST_FREE_KB=20000
# At these voltages the brick itself warns. An empty battery must not cut writing to the card short.
LEAST_LITHIUM_UV=6500000
LEAST_OTHER_UV=5500000
READY_S=60
STOP_S=5

card_takes_writes() { # or why says why not
    why=$( (date >"$HOME/.kickctl-probe" && rm "$HOME/.kickctl-probe") 2>&1) || {
        rm -f "$HOME/.kickctl-probe" 2>/dev/null || true
        why=${why##*: }
        return 1
    }
}

need_card() {
    card_takes_writes ||
        give_up 4 "the brick's card cannot be written: $why" "if it is full, delete old files\
 there. If not, Linux has closed it as it is locked or fails: switch the brick off and on, then try\
 another card"
}

only_one() {
    need_card
    mkdir -p "$ROOT"
    exec 9>>"$ROOT/lock"
    flock -n 9 ||
        give_up 1 "somebody else is deploying to this brick just now" "wait until they are done"
}

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

ask_password() { # before anything is touched
    as_root true || give_up 1 "a service needs the brick's administrator" \
        "deploy at a terminal, where sudo can ask for the password"
}

switch() { # switch LINK RELEASE: in one step, so that the link always leads somewhere
    ln -sfn "releases/$2" "$ROOT/$1.new" && mv -fT "$ROOT/$1.new" "$ROOT/$1"
}

check() { # whether this machine can run the program at all
    version=$(python3 -S -c '
import sys
print("%d.%d.%d" % sys.version_info[:3])
sys.exit(sys.version_info < (3, 5))' 2>/dev/null) ||
        give_up 4 "the brick's python3 is ${version:-missing}; the program needs 3.5 or newer" \
            "is this an EV3 with ev3dev-stretch? Its card has Python 3.5.3"
    need_card
    free=$(df -Pk "$HOME" | awk 'NR == 2 { print $4 + 0 }')
    [ "${free:-0}" -ge "$LEAST_FREE_KB" ] ||
        give_up 4 "the brick's card has $((free / 1000)) MB left" \
            "$((LEAST_FREE_KB / 1000)) MB are needed:\
 delete old files there; 'du -ah ~ | sort -h | tail' on the brick shows large ones"
    least=$LEAST_OTHER_UV
    supply=$CLASS/power_supply/lego-ev3-battery
    [ "$(cat "$supply/technology" 2>/dev/null)" != Li-ion ] || least=$LEAST_LITHIUM_UV
    battery=$(cat "$supply/voltage_now" 2>/dev/null || true)
    case $battery in *[!0-9]*) battery='' ;; esac
    [ "${battery:-$least}" -ge "$least" ] ||
        give_up 4 "the brick's battery is low: $(volts "$battery") of $(volts "$least") needed" \
            "charge it, or put in fresh cells, and try again"
    tell "Python $version, $((free / 1000)) MB free, battery $(volts "$battery")"
}

volts() { [ -n "$1" ] && echo "$1" | awk '{ printf "%.2f V", $1 / 1e6 }' || echo "not measured"; }

is_token() { # is_token TEXT: 32 bytes in hexadecimal
    case $1 in *[!0-9A-Fa-f]*) return 1 ;; esac
    [ "${#1}" = 64 ]
}

show_token() {
    [ -e "$TOKEN" ] || { tell "kickctl-token=none=" && return; }
    there=$(tr -d '[:space:]' <"$TOKEN" || true)
    is_token "$there" || give_up 1 "the brick's file $TOKEN holds no token" \
        "delete it on the brick (rm $TOKEN), then deploy again to make a new one"
    tell "kickctl-token=$there="
}

token() { # keep standard input as the robot's token
    given=$(tr -d '[:space:]')
    is_token "$given" || give_up 1 "what arrived on the brick is no token" "deploy again"
    before=$({ tr -d '[:space:]' <"$TOKEN"; } 2>/dev/null || true)
    [ -z "$before" ] || [ "$before" = "$given" ] ||
        tell "  the brick had another token: machines with that one can no longer command it"
    umask 077
    { mkdir -p "${TOKEN%/*}" && echo "$given" >"$TOKEN.new" && mv -f "$TOKEN.new" "$TOKEN"; } ||
        give_up 1 "the brick's file $TOKEN cannot be written" "see above why; then deploy again"
}

has() { # has RELEASE: whether it is there and whole
    { cd "$ROOT/releases/$1" && sha256sum --quiet -c SHA256SUMS; } >/dev/null 2>&1 || exit 1
}

adopt() { # adopt RELEASE FOLDER: make a release of an upload, if it is sound
    only_one
    cd "$ROOT/releases/$2"
    sha256sum --quiet -c SHA256SUMS ||
        discard "$2" "the upload arrived damaged" \
            "try again; if it happens each time, the card may be failing"
    python3 -S -m robot.compile || {
        card_takes_writes || discard "$2" "the brick's card cannot be written: $why" \
            "delete old files there; if it happens each time, the card may be failing"
        discard "$2" "the brick's Python cannot read this release" \
            "if you changed it: 'make lint' finds what is too new for Python 3.5"
    }
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

reset_motors() { # a motor under run-direct keeps turning without its program
    for command in "$CLASS"/tacho-motor/motor*/command; do
        [ ! -e "$command" ] || echo reset >"$command" ||
            tell "deploy: $command could not be written: pull that motor's cable if it turns"
    done
}

motors() { # in words, what the kernel says of the motors
    on='' seen=''
    for motor in "$CLASS"/tacho-motor/motor*; do
        [ -e "$motor" ] || continue
        seen=yes
        state=$(cat "$motor/state" 2>/dev/null) || state="no state"
        [ -z "$state" ] || on="$on${on:+, }${motor##*/} reads '$state'"
    done
    if [ -n "$on" ]; then
        tell "motors may be on: $on. Pull their cables if they turn"
    elif [ -n "$seen" ]; then
        tell "the motors are off"
    else
        tell "the brick sees no motor"
    fi
}

# When the program does not answer: the kernel can switch the motors off without it.
halt() {
    reset_motors
    tell "kickctl-motors=$(motors)="
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

keep_arguments() {
    printf '%s\n' "$1" >"$ROOT/arguments.new" && mv -f "$ROOT/arguments.new" "$ROOT/arguments"
}

warn() { # of wheels that turn; a service starts with its motors off
    [ ! -e "$UNIT" ] || return 0
    case " $(arguments) " in
    *" --idle "*) ;;
    *)
        tell "The wheels will turn as soon as the program is ready: hold the robot up."
        tell "  With --idle in KICK_ROBOT_ARGS they stand still."
        ;;
    esac
}

start_program() { # start the current release and wait until it is ready and well
    warn
    rm -f "$ROOT/robot.pid" "$RUN/robot.pid" "$RUN/robot.log"
    [ ! -e "$ROOT/robot.log" ] || mv -f "$ROOT/robot.log" "$ROOT/robot.log.1"
    if [ -e "$UNIT" ]; then
        # Or systemd counts the starts of the last minutes.
        as_root systemctl reset-failed kickctl 2>/dev/null || true
        as_root systemctl start --no-block kickctl ||
            { tell "systemd did not start it" && return 1; }
    else
        setsid nice -n -10 sh "$ROOT/current/robot/service/brick.sh" run \
            </dev/null >/dev/null 2>&1 9>&- &
    fi
    waited=0
    while [ -z "$(port)" ]; do
        # An empty robot.pid belongs to a program that is about to write its number.
        if [ -s "$(kept robot.pid)" ] && [ -z "$(program_pid)" ]; then
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

remove_service() { # all that is there of it, after the program was stopped
    rm -f "$ROOT/unit.new"
    [ ! -e "$UNIT" ] || as_root systemctl disable kickctl || true
    as_root rm -f "$UNIT" "$AVAHI"
    as_root systemctl daemon-reload || true
}

announce() { # have avahi announce the robot in the network; all else works without
    sed -e "s|@USER@|$(id -un)|" -e "s|@PORT@|$(port)|" \
        "$ROOT/current/robot/service/kickctl-avahi.service" >"$ROOT/avahi.new"
    as_root install -D -m 644 "$ROOT/avahi.new" "$AVAHI" ||
        tell "  the robot cannot announce itself: kickctl discover will not list it"
    rm -f "$ROOT/avahi.new"
}

# activate RELEASE [service|'' [ARGUMENTS]]: run it from now on, as a service and with these
# arguments if they are given; if it is not well, run the release before again, as it was.
activate() {
    only_one
    trap '' HUP INT PIPE # nobody may stop this half-way, not even by hanging up
    [ -d "$ROOT/releases/$1" ] || give_up 1 "there is no release $1 on the brick" "deploy it again"
    new=$1 as=${2-}
    served=''
    [ ! -e "$UNIT" ] || served=yes
    [ -z "$as$served" ] || ask_password
    old=$(release current)
    old_arguments=$(arguments)
    tell "stopping the robot's program, resetting its motors"
    stop_program
    tell "starting $new"
    if switch current "$new" && { [ -z "${3+given}" ] || keep_arguments "$3"; } &&
        { [ -z "$as" ] || install_service; } && start_program; then
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
    tell "$(tail -n 15 "$(kept robot.log)" 2>/dev/null | sed 's/^/    /')"
}

go_back() { # from activate, whose variables it uses; exits
    mend="mend the cause that its last words name, and deploy again"
    again="$old runs again"
    failed_arguments=$(arguments)
    if [ "$failed_arguments" != "$old_arguments" ]; then
        keep_arguments "$old_arguments" || true
        again="$again, with the arguments of before ('$old_arguments'"
        again="$again instead of '$failed_arguments')"
    fi
    if [ -z "$old" ]; then
        rm -f "$ROOT/current"
        give_up 5 "release $new does not run, and there was none before it; $(motors)" \
            "$mend"
    fi
    tell "starting $old again"
    switch current "$old" || true
    # Its own unit file, instead of that of the new one.
    [ -z "$served" ] || [ -z "$as" ] || install_service || true
    if start_program; then
        prune
        give_up 1 "release $new did not run; $again" "$mend"
    fi
    stop_program
    give_up 5 "neither $new nor $old runs; $(motors)" \
        "does another program use the motors? The brick's log may say: deploy with --logs shows it"
}

prune() { # keep the release that runs and the one before
    for folder in "$ROOT"/releases/*; do
        case ${folder##*/} in
        "$(release current)" | "$(release previous)") ;;
        *) rm -rf "$folder" ;;
        esac
    done
}

rollback() {
    [ -n "$(release current)" ] ||
        give_up 1 "no release is on this brick, and none to go back to" "deploy one first"
    before=$(release previous)
    [ -n "$before" ] || give_up 1 "there is no release before this one on the brick" \
        "install or check out the one that you want, and deploy it"
    activate "$before"
}

no_service() { # from now on the release runs when deploy.sh starts it
    [ -e "$UNIT" ] || [ -e "$AVAHI" ] ||
        give_up 1 "the robot's program is no service of this brick" "so there is nothing to undo"
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
        give_up 5 "the program is no service any more, but does not run; $(motors)" \
            "deploy it again"
    }
    done_well
}
