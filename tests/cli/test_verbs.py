"""The other verbs on the embedded simulated robot."""

import json

import numpy as np
import pytest

from host.logs.log import Log

LOG_VERBS = ("export", "replay")


def test_the_demo_kicks_the_robot_and_the_claims_hold_in_its_log(kickctl):
    status, out, _ = kickctl("demo", "--seed", "4", "--json")
    result = json.loads(out)
    assert status == 0
    assert result["before"] == {"left": "forward", "right": "forward"}
    assert result["after"] == {"left": "backward", "right": "backward"}
    assert [claim["id"] for claim in result["claims"]] == ["R1", "R2", "R3", "R4", "R5", "R8"]
    assert all(claim["holds"] for claim in result["claims"])
    assert Log.load(result["log"]).missing() == []
    assert json.loads(kickctl("log", "replay", result["log"], "--json")[1])["exact"] is True


@pytest.mark.parametrize(
    ("robot", "undecided", "words"),
    [
        ("sim://?seed=4", {"R1", "R8"}, "too few"),
        # Both wheels go forward, so no plan has to be computed for this k.
        ("sim://?seed=6&k=7", {"R1", "R2", "R3", "R4", "R5", "R8"}, "made for k = 8 (here 7)"),
        ("sim://?seed=4&battery=7", {"R1", "R2", "R3", "R4", "R5", "R8"}, "battery = 7.5 V"),
    ],
)
def test_a_demo_with_few_trials_or_of_another_robot_leaves_claims_undecided_and_succeeds(
    kickctl, monkeypatch, robot, undecided, words
):
    monkeypatch.setattr("host.commands.demo.STARTS", 1)
    monkeypatch.setattr("host.commands.demo.INVERSIONS", 1)
    status, out, _ = kickctl("demo", "--brick", robot, "--json")
    claims = json.loads(out)["claims"]
    assert status == 0
    assert {claim["id"] for claim in claims if claim["holds"] is None} == undecided
    assert all(words in claim["note"] for claim in claims if claim["holds"] is None)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("primitive", ["forward", "backward", "spin-left", "spin-right"])
def test_drive_reaches_every_primitive(kickctl, primitive, seed):
    status, out, _ = kickctl("drive", primitive, "--seed", str(seed), "--json")
    result = json.loads(out)
    assert status == 0
    wanted = {"forward": "++", "backward": "--", "spin-left": "-+", "spin-right": "+-"}[primitive]
    log = Log.load(result["log"])
    for side, sign in zip(("left", "right"), wanted, strict=True):
        assert result["after"][side] == {"+": "forward", "-": "backward"}[sign]
        assert log.omega(side)[-10:].mean() * {"+": 1, "-": -1}[sign] > 10


def test_drive_goes_into_chaos_and_says_what_a_real_robot_needs(kickctl):
    status, out, err = kickctl("drive", "chaos", "--brick", "sim://?grip=1.7&seed=3", "--json")
    result = json.loads(out)
    assert status == 0
    assert result["reached"] is True
    assert result["params"] == {"k": 15.0, "tau_s": 1.0, "rod_lag_s": 0.006}
    assert min(result["turns"].values()) >= 3
    assert "7.2 to 7.5 V" in err
    assert json.loads(kickctl("log", "replay", result["log"], "--json")[1])["exact"] is True


def test_drive_stopped_rests_by_a_pulse_of_k_and_stays_at_rest(kickctl):
    status, out, _ = kickctl("drive", "stopped", "--seed", "1", "--json")
    result = json.loads(out)
    assert status == 0
    assert result["after"] == {"left": "stopped", "right": "stopped"}
    assert {kick["mode"] for kick in result["kicks"]} == {"pulse"}
    log = Log.load(result["log"])
    assert log.records[-1].state == 1
    for side in ("left", "right"):
        assert np.ptp(log.column(side + "_phi_rad")[-30:]) <= np.pi / 180 + 1e-9


def test_record_then_list_export_replay(kickctl):
    status, out, _ = kickctl("record", "3", "--seed", "1", "--json")
    result = json.loads(out)
    assert (status, result["missing"]) == (0, 0)
    assert 100 <= result["ticks"] <= 103
    listed = json.loads(kickctl("log", "list", "--json")[1])["logs"]
    assert [(row["path"], row["ticks"]) for row in listed] == [(result["log"], result["ticks"])]
    assert kickctl("log", "export", result["log"], "--format", "npz")[0] == 0
    table = np.load(result["log"].replace(".mcap", ".npz"))
    assert len(table["tick"]) == result["ticks"]
    assert kickctl("log", "replay", result["log"])[0] == 0


def test_pull_fetches_the_black_box(kickctl):
    result = json.loads(kickctl("log", "pull", "--brick", "sim://?seed=2", "--json")[1])
    log = Log.load(result["log"])
    assert log.records[0].tick == 0
    assert len(log) == result["ticks"] > 0


def test_replay_finds_a_changed_bit(kickctl):
    path = json.loads(kickctl("record", "2", "--seed", "1", "--json")[1])["log"]
    log = Log.load(path)
    changed = log.records[40]
    log.records[40] = changed._replace(left_x1=np.nextafter(changed.left_x1, 2.0))
    log.save("changed.mcap")
    status, out, _ = kickctl("log", "replay", "changed.mcap", "--json")
    assert status == 1
    assert str(changed.tick) in json.loads(out)["first_mismatch"]
    assert "left_x1" in json.loads(out)["first_mismatch"]


def _params(kickctl):
    return json.loads(kickctl("params", "list", "--json")[1])["params"]


def test_params_list_has_what_scripts_rely_on(kickctl):
    rows = {row["name"]: row for row in _params(kickctl)}
    assert set(rows) >= {
        "a",
        "tau_s",
        "k",
        "tick_s",
        "max_duty_pct",
        "rods",
        "polarity_left",
        "polarity_right",
        "link_loss",
    }
    for row in rows.values():
        assert set(row) >= {"name", "value", "unit", "minimum", "maximum", "default", "doc"}
    assert (
        rows["k"]["value"],
        rows["tau_s"]["value"],
        rows["tick_s"]["value"],
        rows["max_duty_pct"]["value"],
    ) == (8.0, 0.25, 0.03, 85.0)


def test_params_list_says_what_is_taken_now(kickctl):
    listed = ("--set", "tick_s=0.06", "--set", "rod_lag_s=0.015", "params", "list")
    rows = {row["name"]: row for row in json.loads(kickctl(*listed, "--json")[1])["params"]}
    ranges = {name: (rows[name]["minimum"], rows[name]["maximum"]) for name in ("tau_s", "tick_s")}
    assert ranges == {"tau_s": (0.18, 10.0), "tick_s": (0.015, 0.0833)}
    assert "0.18 to 10" in kickctl(*listed)[1]


def test_params_set_and_get(kickctl):
    assert json.loads(kickctl("params", "set", "k=2.5", "link_loss=hold", "--json")[1]) == {
        "k": 2.5,
        "link_loss": "hold",
    }
    assert json.loads(kickctl("params", "get", "k", "--json")[1]) == {"k": 8.0}


def test_params_reset_brings_all_defaults_back_or_those_that_are_named(kickctl):
    changed = ("--brick", "sim://?k=2&tau_s=1&link_loss=hold", "params", "reset")
    assert json.loads(kickctl(*changed, "--json")[1]) == {
        "tau_s": 0.25,
        "k": 8.0,
        "link_loss": "stop",
    }
    status, out, err = kickctl(*changed, "tau_s", "a")
    assert (status, out) == (0, "tau_s = 0.25 s\n")
    assert "ends with this command" in err
    status, out, err = kickctl("params", "reset")
    assert (status, out) == (0, "")
    assert "nothing to reset" in err
    assert json.loads(kickctl("params", "reset", "k", "--json")[1]) == {}


def test_params_reset_without_names_leaves_how_the_motors_are_mounted(kickctl):
    mirrored = ("--brick", "sim://?polarity_right=-1&k=2&idle=1", "params", "reset")
    status, out, err = kickctl(*mirrored)
    assert (status, out) == (0, "k = 8.0\n")
    assert "kickctl params reset polarity_right" in err
    assert kickctl(*mirrored, "polarity_right")[1] == "polarity_right = 1\n"


def test_params_reset_changes_all_or_nothing(kickctl):
    running = "sim://?polarity_right=-1&k=2"
    status, out, err = kickctl("--brick", running, "params", "reset", "k", "polarity_right")
    assert (status, out) == (1, "")
    assert "polarity_right cannot change while the robot runs" in err
    assert kickctl("params", "reset", "mass")[0] == 2


def test_a_number_without_a_unit_is_shown_without_one(kickctl):
    assert kickctl("params", "get", "k", "tau_s", "link_loss")[1].splitlines() == [
        "k = 8.0",
        "tau_s = 0.25 s",
        "link_loss = stop",
    ]
    lines = kickctl("params", "list")[1].splitlines()
    (row,) = [line.split()[:4] for line in lines if line.startswith("k ")]
    assert row == ["k", "8.0", "0.0", "to"]


@pytest.mark.parametrize(
    "arguments", [("params", "set", "k=2,5"), ("status", "--brick", "sim://?k=2,5")]
)
def test_a_decimal_comma_is_answered_with_the_point(kickctl, arguments):
    status, _, err = kickctl(*arguments)
    assert status in (2, 4)
    assert "k cannot be '2,5'\n  write a point: 2.5\n" in err


def test_params_set_says_that_the_embedded_robot_ends_and_what_to_use_instead(kickctl):
    status, out, err = kickctl("params", "set", "k=2.5", "tau_s=1")
    assert (status, out) == (0, "k = 2.5\ntau_s = 1.0 s\n")
    assert "ends with this command" in err
    assert "--set k=2.5 --set tau_s=1" in err
    assert "'sim://?k=2.5&tau_s=1'" in err
    assert "python -m sim_motor" in err


@pytest.mark.parametrize(
    "arguments",
    [
        ("--set", "k=2", "--set", "tau_s=1", "status", "--json"),
        ("status", "--set", "k=2", "--set", "tau_s=1", "--json"),
        ("--set", "k=2", "status", "--json", "--set", "tau_s=1"),
        ("status", "--json", "--brick", "sim://?k=2", "--set", "tau_s=1"),
        ("status", "--json", "--brick", "sim://?k=9&tau_s=1", "--set", "k=2"),
        ("status", "--json", "--brick", "sim://?k=2&tau_s=1"),
    ],
)
def test_the_embedded_robot_begins_with_the_parameters_that_it_is_given(kickctl, arguments):
    params = json.loads(kickctl(*arguments)[1])["params"]
    assert (params["k"], params["tau_s"]) == (2.0, 1.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("status", "--set", "k=-1"), "k cannot be -1"),
        (("status", "--set", "k"), "'k' sets nothing"),
        (("status", "--set", "=2"), "'=2' sets nothing"),
        (("status", "--set", "mass=2"), "no option 'mass'"),
        (("status", "--set", "k=2", "--brick", "tcp://127.0.0.1:1"), "params set k=2"),
        (("experiment", "timeline", "--set", "k=2"), "sets those of its robots itself"),
        (("discover", "--set", "k=2"), "`kickctl discover` has none"),
    ],
)
def test_parameters_that_go_nowhere_are_refused(kickctl, arguments, words):
    status, out, err = kickctl(*arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert list(kickctl.folder.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ("params", "set", "k=nan"),
        ("params", "set", "k=1e9"),
        ("params", "set", "k=2", "tau_s=0.05"),
        ("params", "set", "mass=1"),
        ("params", "set", "k"),
        ("params", "get"),
        ("params", "list", "k"),
        ("drive", "sideways"),
        ("record", "-1"),
        ("record", "nan"),
        ("log", "export", "nowhere.mcap"),
        ("log", "replay", "nowhere.mcap"),
        ("log", "list", "nowhere"),
        ("fly",),
        (),
    ],
)
def test_wrong_use_exits_2_in_words(kickctl, arguments):
    status, out, err = kickctl(*arguments)
    assert (status, out) == (2, "")
    assert "Traceback" not in err
    assert len(err) > 20


def test_an_error_is_an_object_too_when_json_is_asked_for(kickctl):
    status, out, err = kickctl("status", "--brick", "tcp://127.0.0.1:1", "--json")
    error = json.loads(out)["error"]
    assert status == error["status"] == 3
    assert error["message"] in err


def test_options_may_stand_before_the_verb_or_after_it(kickctl):
    before = json.loads(kickctl("--json", "--seed", "7", "status")[1])
    after = json.loads(kickctl("status", "--seed", "7", "--json")[1])
    assert before["seed"] == after["seed"] == 7


def test_status_start_stop_clear(kickctl):
    assert json.loads(kickctl("status", "--json")[1])["state"] == "running"
    assert (
        json.loads(kickctl("start", "--brick", "sim://?idle=1", "--json")[1])["state"] == "running"
    )
    assert kickctl("clear")[0] == 1


def test_doctor_finds_the_simulated_robot_well(kickctl):
    status, out, _ = kickctl("doctor", "--json")
    assert (status, json.loads(out)["well"]) == (0, True)
    (same,) = [one for one in json.loads(out)["findings"] if one["what"] == "sources"]
    assert same["found"].startswith("robot and host run the same (")
    assert not same["remedy"]


@pytest.mark.parametrize(
    ("own", "words"),
    [("0123456789abcdef", "different ones"), ("", "does not say them")],
)
def test_doctor_says_where_robot_and_host_run_other_sources(kickctl, monkeypatch, own, words):
    monkeypatch.setattr("robot.session._SOURCES", own)
    status, out, _ = kickctl("doctor", "--json")
    (other,) = [one for one in json.loads(out)["findings"] if one["what"] == "sources"]
    assert status == 1
    assert words in other["found"]
    assert "deploy" in other["remedy"]


def test_doctor_points_at_an_open_token_file(kickctl):
    token = kickctl.folder / "token"
    token.write_text("00" * 32)
    token.chmod(0o644)
    status, out, _ = kickctl("doctor", "--brick", "tcp://127.0.0.1:1", "--json")
    remedies = {finding["what"]: finding["remedy"] for finding in json.loads(out)["findings"]}
    assert status != 0
    assert remedies["token"]


def test_watch_shows_both_wheels(kickctl):
    status, out, _ = kickctl("watch", "--seconds", "0.5", "--json", "--seed", "1")
    lines = [json.loads(line) for line in out.splitlines()]
    assert status == 0
    assert len(lines) >= 3
    assert lines[0]["tick"] < lines[-1]["tick"]
    assert {"left", "right", "state"} <= set(lines[0])
