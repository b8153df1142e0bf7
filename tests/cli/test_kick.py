"""kickctl kick, as a person and as a script use it, on the embedded simulated robot."""

import csv
import io
import json
from itertools import pairwise
from math import degrees

import pytest

from host.logs.log import Log
from robot.record import KICK_NAMES, STATES

OUTCOME = {
    "mode",
    "ticks",
    "shift_rad",
    "wheel",
    "applied_tick",
    "before",
    "after",
    "reversed",
    "settling_s",
}
FIELDS = OUTCOME | {"brick", "seed", "log", "figure"}


def test_the_json_is_one_object_that_says_what_happened(kickctl):
    status, out, err = kickctl("kick", "--mode", "phase", "--ticks", "4", "--json", "--seed", "5")
    result = json.loads(out)
    assert status == 0
    assert out.count("\n") == 1
    assert set(result) >= FIELDS
    assert result["reversed"] is True
    assert (result["mode"], result["ticks"], result["wheel"], result["seed"]) == (
        "phase",
        4,
        "both",
        5,
    )
    for side in ("left", "right"):
        assert {result["before"][side], result["after"][side]} == {"forward", "backward"}
    assert 0.2 < result["settling_s"] < 2.0
    assert "simulated" in err


@pytest.mark.usefixtures("drawn")
def test_log_and_figure_are_what_the_answer_names(kickctl):
    result = json.loads(
        kickctl("kick", "--mode", "phase", "--ticks", "4", "--json", "--seed", "5")[1]
    )
    log = Log.load(kickctl.folder / result["log"])
    marked = [record.tick for record in log.records if KICK_NAMES[record.kick] == "phase"]
    assert marked == list(range(result["applied_tick"], result["applied_tick"] + 4))
    assert log.missing() == []
    assert log.info["seed"] == 5
    assert (kickctl.folder / result["figure"]).read_bytes().startswith(b"\x89PNG")


def test_the_same_seed_gives_the_same_numbers(kickctl):
    tables = []
    for _ in range(2):
        result = json.loads(kickctl("kick", "--mode", "position", "--json", "--seed", "11")[1])
        tables.append(kickctl("log", "export", result["log"])[1])
    assert tables[0] == tables[1]
    other = json.loads(kickctl("kick", "--mode", "position", "--json", "--seed", "12")[1])
    assert kickctl("log", "export", other["log"])[1] != tables[0]


def test_a_kick_of_one_tick_does_not_reverse_and_exits_1(kickctl):
    status, out, err = kickctl("kick", "--mode", "phase", "--ticks", "1", "--json", "--seed", "5")
    result = json.loads(out)
    assert status == 1
    assert result["reversed"] is False
    assert result["before"] == result["after"]
    assert "did not reverse" in err


def test_kicking_one_wheel_leaves_the_other_alone(kickctl):
    status, out, _ = kickctl(
        "kick", "--mode", "membrane", "--wheel", "left", "--json", "--seed", "5"
    )
    result = json.loads(out)
    assert status == 0
    assert result["after"]["left"] != result["before"]["left"]
    assert result["after"]["right"] == result["before"]["right"]


def test_a_positive_shift_ends_forward_motion_and_a_negative_one_backward_motion(kickctl):
    """R10, per sign; what the other sign does depends on the kick's length."""
    ended = 0
    for shift, radians, ends in (
        ("3pi/4", 2.356194490192345, "forward"),
        ("-3pi/4", -2.356194490192345, "backward"),
    ):
        for seed in range(4):
            result = json.loads(
                kickctl(
                    "kick",
                    "--mode",
                    "phase",
                    "--ticks",
                    "3",
                    "--shift",
                    shift,
                    "--json",
                    "--seed",
                    str(seed),
                )[1]
            )
            assert result["shift_rad"] == pytest.approx(radians)
            for side in ("left", "right"):
                if result["before"][side] == ends:
                    ended += 1
                    assert (
                        result["after"][side]
                        == {"forward": "backward", "backward": "forward"}[ends]
                    )
    assert ended >= 6


def test_now_kicks_before_the_wheels_have_settled(kickctl):
    early = json.loads(kickctl("kick", "--mode", "membrane", "--now", "--json", "--seed", "5")[1])
    patient = json.loads(kickctl("kick", "--mode", "membrane", "--json", "--seed", "5")[1])
    assert early["applied_tick"] < patient["applied_tick"]


def test_an_idle_robot_is_not_kicked_and_the_answer_says_how_to_start_it(kickctl):
    status, out, err = kickctl("kick", "--mode", "phase", "--brick", "sim://?idle=1")
    assert (status, out) == (1, "")
    assert "kickctl start" in err
    assert not (kickctl.folder / "logs").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ("--mode", "phase", "--ticks", "0"),
        ("--mode", "phase", "--ticks", "-3"),
        ("--mode", "phase", "--ticks", "100000000"),
        ("--mode", "membrane", "--ticks", "4"),
        ("--mode", "phase", "--shift", "nan"),
        ("--mode", "phase", "--shift", "99pi"),
        ("--mode", "sideways"),
        ("--mode", "pulse"),
        ("--mode", "pulse", "--param", "k"),
        ("--mode", "pulse", "--param", "k", "--value", "nan"),
        ("--mode", "pulse", "--param", "k", "--value", "inf"),
        ("--mode", "pulse", "--param", "k", "--value", "-1"),
        ("--mode", "pulse", "--param", "mass", "--value", "1"),
        ("--mode", "jump", "--variable", "x1"),
        ("--mode", "jump", "--variable", "x1", "--delta", "1e300"),
        ("--mode", "position", "--shift", "1"),
        ("--mode", "phase", "--wheel", "third"),
        ("--mode", "phase", "--brick", "carrier-pigeon://coop"),
        ("--mode", "phase", "--brick", "sim://?motor=steam"),
        ("--mode", "phase", "--brick", "sim://?battery=1000"),
        ("--mode", "phase", "--brick", "tcp://127.0.0.1:99999"),
        ("--mode", "phase", "--brick", "tcp://127.0.0.1:1", "--seed", "1"),
    ],
)
def test_wrong_use_exits_2_in_words_and_leaves_nothing_behind(kickctl, arguments):
    status, out, err = kickctl("kick", *arguments)
    assert (status, out) == (2, "")
    assert "Traceback" not in err
    assert len(err) > 20
    assert list(kickctl.folder.iterdir()) == []


def test_the_general_pulse_and_jump_reach_the_robot(kickctl):
    pulse = json.loads(
        kickctl(
            "kick",
            "--mode",
            "pulse",
            "--param",
            "beta",
            "--value",
            "1",
            "--ticks",
            "3",
            "--json",
            "--seed",
            "5",
        )[1]
    )
    named = json.loads(
        kickctl("kick", "--mode", "position", "--ticks", "3", "--json", "--seed", "5")[1]
    )
    columns = ("left_x1", "right_x2", "left_duty_pct")
    for column in columns:
        assert (
            Log.load(pulse["log"]).column(column) == Log.load(named["log"]).column(column)
        ).all()
    smooth = json.loads(
        kickctl(
            "kick",
            "--mode",
            "position",
            "--ticks",
            "5",
            "--shape",
            "smooth",
            "--json",
            "--seed",
            "5",
        )[1]
    )
    assert smooth["reversed"]
    jump = kickctl(
        "kick", "--mode", "jump", "--variable", "x1", "--delta", "-0.01", "--json", "--seed", "5"
    )
    assert jump[0] == 1
    assert json.loads(jump[1])["reversed"] is False


def test_a_row_of_the_table_is_one_tick_as_it_happened(kickctl):
    """By the paper's equations, angle and delta t give potentials, force, torque and duty."""
    from math import cos, exp, sin, tanh

    result = json.loads(kickctl("kick", "--mode", "phase", "--json", "--seed", "3")[1])
    text = kickctl("log", "export", result["log"], "--format", "csv")[1]
    rows = list(csv.DictReader(io.StringIO(text)))
    wheel = ["phi_rad", "x1", "x2", "force", "torque", "duty_pct", "omega_rad_s"]
    names = [
        "tick",
        "t_s",
        "dt_s",
        *("left_" + name for name in wheel),
        *("right_" + name for name in wheel),
        "kick",
    ]
    assert list(rows[0])[: len(names)] == names
    assert [int(row["tick"]) for row in rows] == list(
        range(int(rows[0]["tick"]), int(rows[0]["tick"]) + len(rows))
    )
    compared = 0
    for before, row in pairwise(rows):
        if row["kick"] or row["state"] != "running":
            continue
        compared += 1
        for side in ("left", "right"):
            phi, x1, x2 = (float(row[f"{side}_{name}"]) for name in ("phi_rad", "x1", "x2"))
            dt, old1, old2 = (
                float(row["dt_s"]),
                float(before[side + "_x1"]),
                float(before[side + "_x2"]),
            )
            assert x1 == pytest.approx(old1 + dt * (cos(phi) - old1) / 0.25, abs=1e-12)
            assert x2 == pytest.approx(old2 + dt * (sin(phi) - old2) / 0.25, abs=1e-12)
            spring = [
                8 * (2 / (1 + exp(-4 * x)) - 1 - seen)
                for x, seen in ((x1, cos(phi)), (x2, sin(phi)))
            ]
            force = spring[0] * sin(phi) - spring[1] * cos(phi)
            assert float(row[side + "_force"]) == pytest.approx(force, abs=1e-9)
            assert float(row[side + "_torque"]) == pytest.approx(tanh(force), abs=1e-9)
            assert int(row[side + "_duty_pct"]) == round(85 * float(row[side + "_torque"]))
    assert compared > 60
    assert {row["kick"] for row in rows} == {"", "phase"}
    assert {row["state"] for row in rows} <= set(STATES)


def test_a_waveform_from_a_file_reverses_and_its_log_replays_bit_for_bit(kickctl):
    file = kickctl.folder / "push.csv"
    file.write_text("beta\n0.9\n1\n1\n0.8\n", encoding="utf-8")
    status, out, _ = kickctl("kick", "--waveform", "push.csv", "--json", "--seed", "5")
    result = json.loads(out)
    assert (status, result["mode"], result["ticks"], result["reversed"]) == (
        0,
        "waveform",
        4,
        True,
    )
    assert "waveform-4-ticks" in result["log"]
    log = Log.load(kickctl.folder / result["log"])
    assert log.kicks()[-1][1]["waveform"] == [0.9, 1.0, 1.0, 0.8]
    assert [KICK_NAMES[record.kick] for record in log.records].count("waveform") == 4
    assert json.loads(kickctl("log", "replay", result["log"], "--json")[1])["worst"] == 0.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "--mode is missing"),
        (("--mode", "waveform"), "name its file: --waveform FILE"),
        (("--waveform", "none.txt"), "cannot be read"),
        (("--waveform", "big.txt"), "value 2 of the waveform of k: k cannot be 101.0"),
        (("--waveform", "big.txt", "--mode", "phase"), "param does not belong to a phase kick"),
        (("--waveform", "big.txt", "--ticks", "2"), "says its own length"),
        (("--mode", "membrane", "--window", "60,84"), "--window is for one wheel"),
        (("--mode", "membrane", "--window", "84,60"), "cannot be '84,60'"),
        (("--mode", "membrane", "--window=60,84,"), "cannot be '60,84,'"),
        (("--mode", "membrane", "--window", "-10,x"), "cannot be '-10,x'"),
    ],
)
def test_a_kick_without_a_form_and_a_wrong_waveform_are_refused_first(kickctl, arguments, words):
    (kickctl.folder / "big.txt").write_text("k\n1\n101\n", encoding="utf-8")
    status, out, err = kickctl("kick", *arguments)
    assert (status, out) == (2, "")
    assert words in err


def test_a_kick_waits_for_its_window_of_angles(kickctl):
    """A pulse that works at some angles only."""
    kick = ("kick", "--mode", "pulse", "--param", "shift_rad", "--value", "1.16583")
    kick += ("--ticks", "7", "--shape", "smooth", "--wheel", "left", "--seed", "1", "--json")
    status, out, _ = kickctl(*kick, "--window", "76,100")
    result = json.loads(out)
    records = Log.load(kickctl.folder / result["log"]).records
    begin = next(record for record in records if record.tick == result["applied_tick"])
    assert (degrees(begin.left_phi_rad) - 76.0) % 90.0 <= 24.0
    assert (status, result["before"]["left"]) == (0, "forward")


def test_a_wheel_that_rests_does_not_come_to_an_angle(kickctl):
    window = ("--wheel", "left", "--window", "10,20", "--now")
    status, out, err = kickctl("kick", "--mode", "phase", *window, "--set", "k=0.01", "--seed", "1")
    assert (status, out) == (1, "")
    assert "did not come to an angle from 10° to 20°" in err
