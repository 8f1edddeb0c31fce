"""Tables read the same in the terminal and as Markdown."""

import math

from rich.console import Console

from evaluation.census import Census, census_table
from experiments.edges import DEFINITIONS, Score, edge_table

NAN = math.nan


def test_the_edge_table():
    scores = {"paper_room": {"virtual_floor": Score(-0.0124, 0.5, 0.25, 1.0, NAN)}}
    table = edge_table(scores, 30, ("near_edge",))
    assert table.rows == [("paper_room", "virtual_floor", "-0.012", "+0.500", "25.0 %", "100.0 %", "-")]
    text = table.markdown()
    assert "| world | scan | median [m] | 95 % [m] | missed | late | false |" in text
    assert "| --- | --- | ---: | ---: | ---: | ---: | ---: |" in text
    assert "| paper_room | virtual_floor | -0.012 | +0.500 | 25.0 % | 100.0 % | - |" in text
    assert text.endswith(DEFINITIONS)


def test_the_census_table():
    table = census_table("a folder", {"fused": Census(0.5, 0.25, 0.25, 1.25), "positive": Census(0.0, 1.0, 0.0, NAN)})
    assert table.rows == [
        ("fused", "50.0 %", "25.0 %", "25.0 %", "1.250"),
        ("positive", "0.0 %", "100.0 %", "0.0 %", "-"),
    ]


def test_the_terminal_shows_every_cell_and_no_heading_is_taken_for_markup():
    console = Console(width=80, record=True, quiet=True)
    table = edge_table(
        {"paper_room_open": {"farthest_point": Score(2.8741, 3.155, 0.0, 0.55, 0.0)}},
        30,
        ("farthest_point", "virtual_floor"),
    )
    with console.capture() as said:
        console.quiet = False
        console.print(table.rich())
    for cell in (*table.headings, *table.rows[0]):
        assert cell in said.get()
