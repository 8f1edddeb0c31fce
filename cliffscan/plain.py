"""Texts of others for the terminal of a person."""

import json


def plain(text: str) -> str:
    """The text with all that a terminal may obey, or that hides or turns letters, written out as JSON does.

    Control and format characters, those of writing direction among them, line breaks and surrogates.
    """
    return "".join(each if each.isprintable() else json.dumps(each)[1:-1] for each in text)
