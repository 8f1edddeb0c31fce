"""No text of others does anything to a terminal."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.plain import plain


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("ok: 3 m, Größe [/x]", "ok: 3 m, Größe [/x]"),
        ("\x1b[2J", "\\u001b[2J"),
        ("a\nb\x7f", "a\\nb\\u007f"),
        ("\u202eabc\u2066", "\\u202eabc\\u2066"),
        ("\u2028", "\\u2028"),
    ],
)
def test_what_a_terminal_may_obey_is_written_out(text, shown):
    assert plain(text) == shown


@given(st.text())
def test_all_is_printable_and_what_was_so_is_left(text):
    assert plain(text).isprintable()
    assert plain(plain(text)) == plain(text)


@given(st.text())
def test_a_line_of_json_stays_what_it_was(text):
    assert json.loads(plain(json.dumps(text, ensure_ascii=False))) == text
