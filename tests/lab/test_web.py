"""The web server over real sockets: who is let in, what is served, what hostile pages can do."""

import signal
import socket
import struct
import threading
from contextlib import suppress

import aiohttp
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from yarl import URL

from host.errors import NotDone, WrongUse
from host.lab.ring import CAPACITY
from host.lab.server import Lab
from host.lab.stepped_station import SteppedStation
from tests.lab.browser import browse, held_up, key, site


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "page"
    (folder / "draw").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>lab</title>", encoding="utf-8")
    (folder / "draw" / "wheel.js").write_text("export const one = 1;", encoding="utf-8")
    (folder / "notes.txt").write_text("nobody's business", encoding="utf-8")
    (folder.parent / "secret.js").write_text("secret", encoding="utf-8")
    (folder / "link.js").symlink_to(folder.parent / "secret.js")
    return folder


@pytest.fixture(scope="module")
def station():
    station = SteppedStation()
    yield station
    station.close()


@pytest.fixture(scope="module")
def lab(station, folder):
    with Lab([station], port=0, folder=folder) as lab:
        yield lab


def fetched(url, **options):
    """(status, headers, body) of an answer."""

    async def scenario(browser):
        async with browser.http.get(url, **options) as answer:
            return answer.status, answer.headers, await answer.text()

    return browse(scenario)


def refused(lab, **options):
    """The status with which a WebSocket is refused."""

    async def scenario(browser):
        with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
            await browser.connect(lab.drive_url, **options)
        return refusal.value.status

    return browse(scenario)


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/", "text/html; charset=utf-8"),
        ("/index.html", "text/html; charset=utf-8"),
        ("/draw/wheel.js", "text/javascript; charset=utf-8"),
    ],
)
def test_files_have_their_types_and_safe_headers(lab, path, kind):
    status, headers, _ = fetched(site(lab.drive_url) + path)
    assert status == 200
    assert headers["Content-Type"] == kind
    assert headers["Cache-Control"] == "no-cache"
    assert headers["Content-Security-Policy"] == "default-src 'self'; frame-ancestors 'none'"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path",
    [
        "/nothing.html",
        "/notes.txt",
        "/draw",
        "/../secret.js",
        "/%2e%2e/secret.js",
        "/draw/..%2f..%2f..%2fsecret.js",
        "/..%5csecret.js",
        "//etc/passwd",
        "/%2fetc%2fpasswd",
        "/link.js",
        "/index.html%00.js",
        "/" + "a" * 3000 + ".js",
    ],
)
def test_nothing_else_is_served(lab, path):
    status, headers, body = fetched(URL(site(lab.drive_url) + path, encoded=True))
    assert status == 404
    assert "secret" not in body
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_who_names_another_host_gets_nothing(lab):
    """A foreign site under a name that leads to this computer: DNS rebinding."""
    port = URL(lab.drive_url).port
    for host in (f"evil.example:{port}", "127.0.0.1:1", "127.0.0.1", f"192.168.0.7:{port}", ""):
        assert fetched(site(lab.drive_url), headers={"Host": host})[0] == 421
        same = f"http://{host}"
        assert refused(lab, origin=same, headers={"Host": host}) == 421
    assert fetched(f"http://localhost:{port}/")[0] == 200


def test_another_site_gets_nothing(lab):
    port = URL(lab.drive_url).port
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", "http://127.0.0.1"):
        assert refused(lab, origin=origin) == 403
        assert fetched(site(lab.drive_url), headers={"Origin": origin})[0] == 403
    assert refused(lab, origin=None) == 403


def test_a_wrong_key_is_refused_in_words_and_hung_up_on(lab):
    async def scenario(browser):
        socket = await browser.connect(lab.drive_url)
        await socket.send_json({"type": "join", "key": "wrong"})
        words = await socket.receive_json()
        return words, (await socket.receive()).type

    words, end = browse(scenario)
    assert words["type"] == "refused"
    assert words["hint"]
    assert end == aiohttp.WSMsgType.CLOSE


def test_a_page_sees_every_record_and_kicks(lab, station):
    async def scenario(browser):
        tab = await browser.open(lab.drive_url)
        welcome = await tab.latest("welcome")
        codes = "".join(row["code"] for row in welcome["robots"][0]["channels"])
        derived = len(welcome["robots"][0]["derived"])
        assert struct.calcsize("<" + codes) + 4 * derived == station.ring._size
        await tab.until_nobody_drives()
        await tab.ask("do", robot="sim", command="start", arguments={})  # if it is stopped
        began = len(tab.records)
        station.step(3.0)
        reply = await tab.ask("do", robot="sim", command="kick", arguments={"mode": "membrane"})
        assert "result" in reply, reply
        tick = reply["result"]["tick"]
        station.step(3.0)
        await tab.until(lambda tab: len(tab.records) >= began + 200)
        ticks = [record[0] for record in tab.records]
        assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
        events = [one["event"] for one in tab.got if one["type"] == "event"]
        assert [one["tick"] for one in events if one["event"] == "kick"] == [tick]
        before = next(record for record in tab.records if record[0] == tick - 1)
        after = next(record for record in tab.records if record[0] == tick)
        # (x1, x2) of the left wheel has jumped to the other side.
        assert before[8] * after[8] + before[9] * after[9] < 0

    browse(scenario)


def test_a_robots_refusal_comes_in_words(lab):
    async def scenario(browser):
        tab = await browser.open(lab.drive_url)
        await tab.ask("take")
        await tab.until_nobody_drives()
        return await tab.ask("do", robot="sim", command="kick", arguments={"mode": "fly"})

    error = browse(scenario)["error"]
    assert "the robot refuses" in error["message"]
    assert error["hint"]


def test_anyone_stops_the_robot(lab, station):
    async def scenario(browser):
        tab = await browser.open(lab.view_url)
        await tab.send("stop", robot=None)
        await tab.until(lambda tab: any(one.get("state") == "stopped" for one in tab.got))
        driver = await browser.open(lab.drive_url)
        await driver.ask("take")
        assert "result" in await driver.ask("do", robot="sim", command="start", arguments={})

    browse(scenario)


def test_huge_and_odd_messages_harm_nobody(lab):
    async def scenario(browser):
        tab = await browser.open(lab.view_url)
        await tab.socket.send_str("x" * 5000)
        assert "4096 bytes" in (await tab.latest("note"))["message"]
        await tab.socket.send_bytes(b"\x00\xff")
        await tab.until(lambda tab: "is not JSON" in tab.got[-1].get("message", ""))
        with suppress(ConnectionError):  # the server may have hung up in the middle of it
            await tab.socket.send_str("x" * 1_000_000)
        while await tab.read() is not None:
            pass
        assert tab.socket.closed
        assert (await browser.open(lab.view_url)).got

    browse(scenario)


@settings(max_examples=20)
@given(st.lists(st.text(max_size=50) | st.binary(max_size=50), max_size=30))
def test_noise_harms_nobody(lab, noise):
    async def scenario(browser):
        tab = await browser.open(lab.view_url)
        for piece in noise:
            if isinstance(piece, str):
                await tab.socket.send_str(piece.encode(errors="replace").decode())
            else:
                await tab.socket.send_bytes(piece)
        reply = await tab.ask("logs")
        assert "result" in reply

    browse(scenario)


def test_bytes_that_are_no_http_harm_nobody(lab):
    port = URL(lab.drive_url).port
    for noise in (b"\x00" * 100, b"GET / HTTP/1.1\r\n" * 50, b"A5K" + bytes(range(256)) * 200):
        with socket.create_connection(("127.0.0.1", port), timeout=20) as connection:
            connection.sendall(noise + b"\r\n\r\n")
            assert b" 400 " in connection.recv(1000)
    assert fetched(site(lab.drive_url))[0] == 200


def test_a_page_that_does_not_read_is_let_go_and_keeps_nobody_waiting(lab):
    """It is let go when more waits for it than a page may have waiting."""
    note = {"type": "note", "message": "n" * 20000, "hint": ""}

    async def scenario(browser):
        deaf = await browser.open(lab.view_url)
        page = lab.session.pages[max(lab.session.pages)]
        deaf.socket._reader._protocol.pause_reading()
        tab = await browser.open(lab.view_url)
        for sent in range(1, 3000):
            lab.hear(note)
            await tab.until(lambda tab, sent=sent: tab.got.count(note) == sent)
            if page.closed:
                break
        assert page.closed
        assert not page.waiting
        await tab.until(lambda tab: tab.got[-1]["type"] == "pages")

    browse(scenario)


def test_who_falls_behind_is_told_how_many_records_are_lost(lab, station):
    async def scenario(browser):
        tab = await browser.open(lab.view_url)
        station.step(0.3)
        await tab.until(lambda tab: tab.records and tab.records[-1][0] == station._tick - 1)
        seen, lost = len(tab.records), 50
        with held_up(lab):
            station.step(0.03 * (CAPACITY + lost))
        await tab.until(lambda tab: tab.records[-1][0] == station._tick - 1)
        assert len(tab.records) - seen == CAPACITY
        assert tab.missed == lost
        assert await tab.latest("lost") == {"type": "lost", "robot": "sim", "records": lost}

    browse(scenario)


def test_a_log_is_recorded_listed_and_downloaded_by_who_has_a_key(lab, station, tmp_path):
    async def scenario(browser):
        tab = await browser.open(lab.drive_url)
        await tab.ask("take")
        await tab.until_nobody_drives()
        reply = await tab.ask("do", robot="sim", command="record", arguments={"on": True})
        name = reply["result"]["log"]
        station.step(1.0)
        await tab.ask("do", robot="sim", command="record", arguments={"on": False})
        listed = (await tab.ask("logs"))["result"]["logs"]
        assert {"name": name, "robot": "sim", "whole": True, "failed": False} in listed
        url = f"{site(lab.drive_url)}/logs/{name}"
        for headers in ({}, {"Authorization": "Bearer x"}, {"Authorization": key(lab.view_url)}):
            async with browser.http.get(url, headers=headers) as answer:
                assert answer.status == 401
        headers = {"Authorization": f"Bearer {key(lab.view_url)}"}
        async with browser.http.get(url, headers=headers) as answer:
            assert answer.status == 200
            whole = await answer.read()
        assert whole == (tmp_path / "logs" / name).read_bytes()
        (tmp_path / "logs" / "other.mcap").write_text("another's", encoding="utf-8")
        for other in ("other.mcap", "..%2fother.mcap", "", f"{name}%00"):
            path = URL(f"{site(lab.drive_url)}/logs/{other}", encoded=True)
            async with browser.http.get(path, headers=headers) as answer:
                assert answer.status == 404

    browse(scenario)


def test_a_port_that_is_taken_is_said_in_words(lab, station, folder):
    with (
        pytest.raises(NotDone, match="is taken") as error,
        Lab([], port=URL(lab.drive_url).port, folder=folder),
    ):
        pass
    assert "--port" in error.value.hint
    with pytest.raises(WrongUse, match="cannot listen at"), Lab([], 0, "192.0.2.1", folder):
        pass


def test_an_interrupt_that_wakes_no_thread_ends_the_lab(folder, monkeypatch):
    """It comes just before the thread that waits falls asleep: here another thread gets it."""
    monkeypatch.setattr("host.lab.server.LOOK_S", 0.01)
    with Lab([], folder=folder) as lab, pytest.raises(KeyboardInterrupt):
        threading.Timer(0.05, signal.raise_signal, [signal.SIGINT]).start()
        lab.wait()


def test_keys_are_new_for_each_lab(lab, folder):
    with Lab([], port=0, folder=folder) as other:
        keys = {key(url) for one in (lab, other) for url in (one.drive_url, one.view_url)}
        assert len(keys) == 4
        assert all(len(one) >= 22 for one in keys)
        assert repr(other.keys) == "Keys()"


def test_others_in_the_network_watch_and_do_not_drive(folder):
    """Another address of this computer stands for its address in a network."""
    with Lab([], port=0, host="127.0.0.2", folder=folder) as lab:
        assert lab.view_url.startswith("http://127.0.0.2:")
        assert lab.drive_url.startswith("http://127.0.0.1:")
        assert fetched(site(lab.view_url))[0] == 200
        other = lab.view_url.replace("127.0.0.2", "127.0.0.1")
        assert fetched(site(other), headers={"Host": URL(lab.view_url).authority})[0] == 421
