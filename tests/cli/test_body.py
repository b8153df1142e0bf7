"""kickctl body: what it answers, what it writes, and how it refuses."""

import csv
import json
from importlib.resources import files

import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader

from sim_motor.bodies.model import SCENES

CAR = ("body", "car", "--time", "1.5", "--seed", "4")


def test_a_folder_that_cannot_be_created_is_refused(kickctl, tmp_path):
    (tmp_path / "file").touch()
    status, out, err = kickctl(*CAR, "--out", str(tmp_path / "file"))
    assert (status, out) == (2, "")
    assert "cannot hold results" in err
    assert "--out" in err


@pytest.mark.usefixtures("drawn")
def test_a_car_is_summarized_in_json_and_kept_in_files(kickctl, tmp_path):
    kick = "t=0.5,mode=phase,wheel=left,seconds=0.2,shift=pi/2"
    status, out, _ = kickctl(*CAR, "--json", "--out", str(tmp_path), "--kick", kick)
    summary = json.loads(out)
    assert status == 0
    measures = {"reversals", "mean_speed", "order_parameter", "path_length", "flipped", "stuck"}
    assert measures <= set(summary)
    assert (summary["cars"], summary["seed"], summary["time_s"]) == (1, 4, pytest.approx(1.5))
    folder = tmp_path / summary["folder"].split("/")[-1]
    with (folder / "state.csv").open(newline="", encoding="utf-8") as file:
        columns, *rows = csv.reader(file)
    assert {
        "t_s",
        "car0_left_phi_rad",
        "car0_right_omega_rad_s",
        "car0_left_x",
        "car0_left_target",
        "car0_left_torque_nm",
    } <= set(columns)
    assert "car0_yaw_rad" in columns
    values = np.array(rows, dtype=float)
    assert values.shape == (301, len(columns))
    with (folder / "state.mcap").open("rb") as file:
        messages = [
            json.loads(message.data)
            for _, _, message in make_reader(file).iter_messages(topics=["/state"])
        ]
    assert np.array([list(message.values()) for message in messages]).tobytes() == values.tobytes()
    assert (folder / "body.png").stat().st_size > 10000
    assert json.loads((folder / "summary.json").read_text())["mean_speed"] == summary["mean_speed"]


def test_another_scene_under_the_same_name_does_not_replace_the_results_of_the_first(
    kickctl, tmp_path
):
    scenes = files("sim_motor") / "bodies" / "scenes"
    (tmp_path / "world.xml").write_text((scenes / "world.xml").read_text())
    own = tmp_path / "own.xml"
    folders = set()
    for place in ("4.35", "2.35", "4.35"):
        own.write_text((scenes / "walls.xml").read_text().replace("4.35", place))
        car = (*CAR, "--time", "0.01", "--scene", str(own), "--json", "--out", str(tmp_path))
        folders.add(json.loads(kickctl(*car)[1])["folder"])
    assert len(folders) == 2


def test_the_parameters_that_are_given_are_those_of_the_car(kickctl, tmp_path):
    speeds = []
    for more in ((), ("--k", "0.9"), ("--drag", "0.5"), ("--preset", "snake2019")):
        _, out, _ = kickctl(*CAR, *more, "--json", "--out", str(tmp_path))
        speeds.append(json.loads(out)["path_length"])
    assert len(set(speeds)) == 4


def test_the_model_is_a_file_for_any_viewer(kickctl, tmp_path):
    path, train = str(tmp_path / "train.xml"), ("body", "train", "--cars", "3", "--time", "0.1")
    status, _, _ = kickctl(*train, "--out", str(tmp_path), "--model", path)
    model = mujoco.MjModel.from_xml_path(path)
    assert (status, model.nu) == (0, 6)


@pytest.mark.parametrize(
    "numbers",
    [
        ("--k", "1e9"),
        ("--k", "1e13"),  # a torque that MuJoCo would take for 0
        ("--drag", "1e9"),
        ("--torque", "1e300"),
        ("--a", "1e308", "--k", "1e308"),
    ],
)
def test_what_was_simulated_before_it_became_unstable_is_kept(kickctl, tmp_path, numbers):
    status, _, err = kickctl(*CAR, *numbers, "--out", str(tmp_path))
    assert status == 1
    assert "cannot be followed" in err
    assert "are kept in" in err
    (states,) = tmp_path.glob("*/state.csv")
    with states.open(newline="", encoding="utf-8") as file:
        _, *rows = csv.reader(file)
    assert len(rows) >= 1
    assert np.isfinite(np.array(rows, dtype=float)).all()


def test_a_run_that_is_interrupted_replaces_no_longer_one(kickctl, tmp_path, monkeypatch):
    def interrupted(keeper):
        raise KeyboardInterrupt

    run = (*CAR, "--time", "0.1", "--out", str(tmp_path))
    kickctl(*run)
    (folder,) = tmp_path.glob("body-*")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    monkeypatch.setattr("host.bodies.keeping.Keeper.note", interrupted)
    status, _, err = kickctl(*run)
    assert status == 130
    assert "keeps the 0.1 s of an earlier run" in err
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_help_names_all_scenes(kickctl):
    _, out, _ = kickctl("body", "--help")
    assert set(SCENES) <= set(out.replace(",", " ").split())


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--scene", "moon"), "no scene"),
        (("--k", "nan"), "k cannot be"),
        (("--tau", "0.0004"), "tau cannot be 0.0004"),
        (("--tau", "1e-9"), "tau cannot be 1e-09"),
        (("--time", "0"), "time"),
        (("--kick", "t=1,mode=shout"), "mode"),
        (("--kick", "mode=phase"), "time"),
        (("--angle", "0.2"), "slopes"),
        (("--bouncy",), "no walls"),
        (("--scene", "box", "--bouncy"), "no walls"),
        (("--torque", "0.01", "--a", "3"), "so a does nothing"),
        (("--torque", "0.01", "--kick", "t=0.01,mode=phase"), "so a kick does nothing"),
        (("--cars", "3"), "one car"),
        (("--cars", "201"), "a whole number of cars, from 1 to 200"),
        (("--scene", "/nowhere/scene.xml"), "scene.xml"),
    ],
)
def test_wrong_use_is_refused_in_words_and_leaves_nothing(kickctl, tmp_path, words, reason):
    status, out, err = kickctl(*CAR, *words, "--out", str(tmp_path / "results"))
    assert (status, out) == (2, "")
    assert reason in err
    assert not (tmp_path / "results").exists()


def test_a_long_train_says_how_long_it_takes_to_build(kickctl, monkeypatch):
    def interrupted(request):
        raise KeyboardInterrupt

    monkeypatch.setattr("host.bodies.build.build_scene", interrupted)
    status, _, err = kickctl("body", "train", "--cars", "100")
    assert status == 130
    assert "building a train of 100 cars, which takes about 5 s" in err
