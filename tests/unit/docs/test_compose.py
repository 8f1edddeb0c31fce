"""What Compose makes of its files, where it is installed."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

TOP = Path(__file__).parents[3]
FILES = ["docker-compose.yml", "docker-compose.secure.yml"]
VARIABLES = {"CAPTURE_SOURCE": "kinect", "KEYS": "/keys"}


def compose():
    """The command, as Docker's plugin or on its own; None where there is none."""
    for command in (["docker", "compose"], ["docker-compose"]):
        if shutil.which(command[0]) and not subprocess.run([*command, "version"], capture_output=True).returncode:
            return command
    return None


COMPOSE = compose()
pytestmark = pytest.mark.skipif(COMPOSE is None, reason="needs the package docker-compose-plugin (docker compose)")


def configured(files, **variables):
    """Compose's answer: its exit code, the services it would start, and what it says."""
    named = [word for file in files for word in ("--file", str(TOP / file))]
    profiles = ["--profile", "robot", "--profile", "workstation"]
    environment = {key: value for key, value in os.environ.items() if key not in (*VARIABLES, "ROBOT_HOST")}
    words = [*COMPOSE, *named, *profiles, "config", "--format", "json"]
    asked = subprocess.run(words, env=environment | variables, capture_output=True, text=True, check=False)
    return asked.returncode, json.loads(asked.stdout)["services"] if not asked.returncode else {}, asked.stderr


@pytest.mark.parametrize("files", [FILES[:1], FILES])
def test_docker_makes_no_folder_in_the_place_of_what_is_mounted(files):
    code, services, said = configured(files, **VARIABLES)
    assert code == 0, said
    mounts = [mount for service in services.values() for mount in service.get("volumes", [])]
    assert mounts
    assert all(mount["bind"]["create_host_path"] is False for mount in mounts)


@pytest.mark.parametrize("files", [FILES[:1], FILES])
def test_a_workstation_without_a_robot_names_no_host(files):
    def joined(**variables):
        return configured(files, **VARIABLES, **variables)[1]["router-workstation"]["command"][-1]

    assert joined().endswith("/:7447")  # which the router refuses
    assert joined(ROBOT_HOST="robot.local").endswith("/robot.local:7447")


def test_a_camera_and_keys_must_be_named():
    for files, missing in ((FILES[:1], "CAPTURE_SOURCE"), (FILES, "KEYS")):
        code, _, said = configured(files, **{key: value for key, value in VARIABLES.items() if key != missing})
        assert code != 0
        assert f"variable {missing} is missing a value: is not set" in said
