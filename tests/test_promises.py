"""docs/promises.md: every name that version 1.0 promises is there and means the same."""

import json

from conftest import ROOT
from promised import STORED, broken, joined, promised

from rodsweep.results.file.validation import FORMAT_NUMBER


def test_every_promised_name_means_what_it_meant():
    stored = json.loads(STORED.read_text())
    assert sum(len(names) for sections in stored.values() for names in sections.values()) > 500
    assert broken(stored, promised()) == []


def test_a_name_that_goes_or_changes_is_seen():
    today = {"statuses": {"spectrum": {"ok": "0", "failed": "5"}}}
    assert broken(today, today) == []
    assert broken({"statuses": {"spectrum": {"ok": "1"}}}, today) == ["statuses: spectrum ok was '1', is '0'"]
    assert broken({"statuses": {"spectrum": {"torn": "6"}}}, today) == [
        "statuses: spectrum torn was '6', is 'gone'"
    ]
    assert joined({"statuses": {"spectrum": {"torn": "6"}}}, today)["statuses"]["spectrum"] == {
        "torn": "6",
        "ok": "0",
        "failed": "5",
    }


def test_the_page_names_every_kind_of_promise_and_the_format():
    page = (ROOT / "docs" / "promises.md").read_text()
    assert all(f"**{kind.capitalize()}**" in page for kind in json.loads(STORED.read_text()))
    assert f"`format` {FORMAT_NUMBER}" in page
