"""The report replaces an earlier report, and nothing else."""

import pytest

from host.runs import html_report
from host.runs.claims import Claim

CLAIM = Claim("R1", "it moves", "", 1.0, "1", None, holds=True)


def test_a_report_replaces_an_earlier_one(tmp_path):
    path = tmp_path / "report.html"
    html_report.write(path, [], {}, [], {})
    assert "it moves" not in path.read_text()
    html_report.write(path, [CLAIM], {}, [], {})
    assert "it moves" in path.read_text()


@pytest.mark.parametrize("text", ["", "my own page", "<html><title>mine</title></html>"])
def test_a_page_of_others_stays(tmp_path, text):
    path = tmp_path / "report.html"
    path.write_text(text)
    with pytest.raises(FileExistsError) as refusal:
        html_report.write(path, [CLAIM], {}, [], {})
    assert refusal.value.filename == str(path)
    assert path.read_text() == text


def test_a_claim_stands_beside_itself_in_the_other_setting(tmp_path):
    path = tmp_path / "report.html"
    fails = Claim("R14", "it is chaotic", "", 0.0, "1", None, holds=False)
    holds = Claim("R14", "it is chaotic", "", 1.0, "1", None, holds=True)
    html_report.write(path, [CLAIM, fails], {"R14": holds}, [], {})
    row = path.read_text().split("<td>R14</td>")[1].split("</tr>")[0]
    assert row.index("does not hold") < row.index(">holds<")
    assert "a hypothesis that fits the paper" in path.read_text()
