"""One page that looks: what it asks for, and what it is sent as fast as it draws."""

import json
import threading
from collections import deque
from typing import Any

import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection

from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.view.outbox import Outbox
from cliffscan.view.packet import numbered, packet
from cliffscan.view.robot_view import PERIODS, Looker, RobotView
from cliffscan.view.robots import ASKED, Robots
from cliffscan.view.sending import send_all

WINDOW = 60  # pictures over which the latency is told
NOT_UNDERSTOOD = 1003  # a close code of RFC 6455
LONGEST_NAME = 100  # characters


class Viewer:
    """A socket of the page.

    The page sends {"watch": robot}, {"ack": number} for each packet that it has shown, {"ask": name, "robot": robot}.
    """

    def __init__(self, connection: ServerConnection, robots: Robots) -> None:
        self._connection = connection
        self._robots = robots
        self._outbox = Outbox(PERIODS)
        self._looker = Looker(self._outbox, self._refresh)
        self._robot = robots.preferred
        self._following = threading.RLock()
        self._view: RobotView | None = None
        self._left = False  # the page is closed, and follows nothing any more
        self._latencies: deque[float] = deque(maxlen=WINDOW)
        self._asking: dict[str, threading.Thread] = {}

    def run(self) -> None:
        """Serve the page until it is closed."""
        sender = threading.Thread(target=self._send, name="view sender", daemon=True)
        leave = self._robots.watch(self._look)
        sender.start()
        try:
            self._look()
            for text in self._connection:
                if not self._receive(text):
                    self._connection.close(NOT_UNDERSTOOD, "expected watch, ack or ask")
                    break
        except ConnectionClosed:
            pass
        finally:
            leave()
            with self._following:
                self._left = True
                self._follow(None)
            self._outbox.close()

    def _receive(self, text: str | bytes) -> bool:
        """Do what a message says; False where it is none."""
        try:
            asked: Any = json.loads(text)
        except ValueError:
            return False
        match asked:
            case {"ack": int(number)}:
                self._acknowledged(number)
            case {"watch": str(robot)} if _is_name(robot):
                with self._following:
                    self._robot = robot
                    self._follow(None)
                    self._look()
            case {"ask": str(name), "robot": str(robot)} if name in ASKED and _is_name(robot):
                self._ask(robot, name)
            case _:
                return False
        return True

    def _acknowledged(self, number: int) -> None:
        shown = self._outbox.acknowledge(number)
        if shown and shown[0] == "scene":
            self._latencies.append(shown[1])

    def _look(self) -> None:
        """Follow the robot as soon as there is a network, and offer how it fares."""
        with self._following:
            if self._view is None and not self._left:  # who looks at all viewers may have begun before it left
                self._follow(self._robots.view(self._robot))
        self._refresh()

    def _refresh(self) -> None:
        self._outbox.offer("state", self._state)

    def _follow(self, view: RobotView | None) -> None:
        with self._following:
            if self._view is not None:
                self._view.leave(self._looker)
            self._view = view
            if view is not None:
                view.join(self._looker)

    def _state(self) -> bytes:
        view = self._view
        shown = view.state() if view else {}
        latency = float(np.median(list(self._latencies))) if self._latencies else None
        return packet({**self._robots.state(view, self._robot), **shown, "latency": latency})

    def _ask(self, robot: str, name: str) -> None:
        """Ask without waiting, unless the same is still unanswered."""
        before = self._asking.get(name)
        if before is None or not before.is_alive():
            self._asking[name] = threading.Thread(target=self._answer, args=(robot, name), daemon=True)
            self._asking[name].start()

    def _answer(self, robot: str, name: str) -> None:
        answer = packet({"kind": "answer", "ask": name, "robot": robot, "text": self._robots.ask(robot, name)})
        self._outbox.offer(f"answer {name}", lambda: answer)

    def _send(self) -> None:
        send_all(self._outbox, lambda number, body: self._connection.send(numbered(number, body)))


def _is_name(robot: str) -> bool:
    return len(robot) <= LONGEST_NAME and ROBOT_NAME.fullmatch(robot) is not None
