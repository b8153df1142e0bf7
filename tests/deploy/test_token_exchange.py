"""The token that both sides need: nothing else is ever taken for it, nothing else is written."""

import re
import subprocess

import pytest

from tests.deploy.brick import needs_sshd, write

# The brick has the release: only the token is new to it.
pytestmark = [needs_sshd, pytest.mark.usefixtures("stocked")]

SECRET = "5a" * 32
SPOILED = ["", "Welcome to EV3 number 7\n", "5a" * 33]


def theirs(brick):
    return brick.home / ".config" / "kickctl" / "token"


@pytest.mark.parametrize(
    "greeting",
    [f"Welcome to EV3 number 7\n\033[2J= =\n{SECRET}\nkickctl-token=", f"{SECRET}\n"],
    ids=["all sorts", "another token"],
)
def test_what_a_login_prints_is_not_the_token(brick, checkout, greeting):
    brick.greet(greeting)
    status, output = checkout.deploy()
    assert status == 0, output
    token = checkout.token.read_text(encoding="ascii")
    assert len(bytes.fromhex(token)) == 32
    assert token.strip() != SECRET
    assert theirs(brick).read_text(encoding="ascii") == token
    checkout.token.unlink()
    status, output = checkout.deploy()
    assert status == 0, output
    assert checkout.token.read_text(encoding="ascii") == token
    # Neither does a greeting change the address in the closing words.
    assert f"--brick '{brick.uri()}' start" in output


@pytest.mark.parametrize("content", SPOILED[1:])
def test_a_spoiled_token_on_the_brick_is_named_and_the_remedy_works(brick, checkout, content):
    write(theirs(brick), content)
    status, output = checkout.deploy()
    assert status == 1, output
    assert f"the brick's file {theirs(brick)} holds no token" in output
    assert not checkout.token.exists()
    assert theirs(brick).read_text(encoding="ascii") == content
    remedy = re.search(r"delete it on the brick \((rm .*)\)", output)[1]
    subprocess.run(["/bin/sh", "-c", remedy], check=True)
    status, output = checkout.deploy()
    assert status == 0, output


def test_a_spoiled_token_on_the_brick_does_not_matter_to_whoever_brings_one(brick, checkout):
    write(theirs(brick), "Welcome to EV3 number 7\n")
    write(checkout.token, SECRET + "\n", 0o600)
    status, output = checkout.deploy()
    assert status == 0, output
    assert theirs(brick).read_text(encoding="ascii") == SECRET + "\n"


@pytest.mark.parametrize("content", SPOILED)
def test_a_spoiled_token_on_this_machine_is_named_and_not_sent(brick, checkout, content):
    write(theirs(brick), SECRET + "\n", 0o600)
    write(checkout.token, content, 0o600)
    status, output = checkout.deploy()
    assert status == 1, output
    assert f"{checkout.token} holds no token" in output
    assert "that file is on this machine" in output
    assert checkout.token.read_text(encoding="ascii") == content
    assert theirs(brick).read_text(encoding="ascii") == SECRET + "\n"
    assert brick.runs() is None


def test_a_token_that_a_person_has_typed_arrives_clean(brick, checkout):
    write(checkout.token, " " + SECRET.upper() + "\r\n\n", 0o600)
    status, output = checkout.deploy()
    assert status == 0, output
    assert theirs(brick).read_text(encoding="ascii") == SECRET.upper() + "\n"


def test_a_token_that_cannot_be_kept_here_is_said(brick, checkout):
    write(theirs(brick), SECRET + "\n", 0o600)
    write(checkout.token.with_name("file"), "")
    status, output = checkout.deploy(KICK_TOKEN=str(checkout.token.with_name("file") / "token"))
    assert status == 1, output
    assert "cannot be written" in output
    assert brick.runs() is None
