"""One colour for one meaning in all pictures; the hues are told apart by colour-blind eyes too (Okabe and Ito)."""

from __future__ import annotations

from cliffscan.common.contract.evidence import Evidence
from experiments.cloud import Kind

GREEN, BLUE, RED, YELLOW, PURPLE = "#009E73", "#0072B2", "#D55E00", "#E6B800", "#AA4499"
BLACK, GREY, PALE = "#000000", "#808080", "#E4E4DC"

OF_KIND = {
    Kind.FLOOR: GREEN,
    Kind.BELOW: BLUE,
    Kind.OBSTACLE: RED,
    Kind.OVERHEAD: YELLOW,
    Kind.NOTHING: BLACK,
}
KIND_NAMES = {
    Kind.FLOOR: "floor band",
    Kind.BELOW: "below the floor",
    Kind.OBSTACLE: "in the robot's way",
    Kind.OVERHEAD: "above the robot",
    Kind.NOTHING: "nothing in range",
}
OF_EVIDENCE = {
    Evidence.POSITIVE: RED,
    Evidence.DROP: BLUE,
    Evidence.FARTHEST_FLOOR: GREEN,
    Evidence.FLOOR_LOST: PURPLE,
    Evidence.EXTRA: GREY,
    Evidence.NOTHING: BLACK,
}
EVIDENCE_NAMES = {
    Evidence.POSITIVE: "positive obstacle",
    Evidence.DROP: "drop seen",
    Evidence.FARTHEST_FLOOR: "farthest floor point",
    Evidence.FLOOR_LOST: "floor lost",
    Evidence.EXTRA: "extra input",
    Evidence.NOTHING: "no evidence told",
}

FLOOR, LOWER, WALL, OVERHEAD = PALE, "#C6D9EC", "#5A5A5A", "#F3E3A1"  # of a world's pieces, seen from above
EDGE = BLACK  # of the floor, where it truly ends
FREE = "#5CCB86"  # beams that looked and found nothing
