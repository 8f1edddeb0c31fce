"""A configuration is read, overridden, or refused with one line that names the key."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.perception.scans import ScanConfig
from cliffscan.common.runtime.config import CONFIGURED, SHARED, ConfigError, dump, home_tables, load, meant_for
from cliffscan.preflight import config_class
from cliffscan.run import service_names
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.fuse.config import FuseConfig
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.positive.config import PositiveConfig

KINDS = {"capture": CaptureConfig, "negative": NegativeConfig, "positive": PositiveConfig, "fuse": FuseConfig}
LIDAR = "fuse.inputs.lidar.key=scan/lidar"


@pytest.fixture
def file(tmp_path):
    """Writes a configuration file."""

    def write(text):
        path = tmp_path / "robot.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def reader(override):
    """A service that reads the table of an override."""
    table = override.split(".")[0]
    return SHARED.get(table, [table])[0]


def overridden(*overrides):
    service = reader(overrides[0])
    return load(service, KINDS[service], None, overrides)


def refusal(service, file, *overrides):
    with pytest.raises(ConfigError) as refused:
        load(service, KINDS[service], file, overrides)
    assert "\n" not in str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize("service", KINDS)
def test_with_nothing_said_the_defaults_hold(service, file):
    assert load(service, KINDS[service], None, []) == KINDS[service]() == load(service, KINDS[service], file(""), [])


def test_a_file_has_a_table_for_each_service(file):
    path = file(
        "[capture]\nrate = 10\n[scan]\nbeams = 90\n[negative]\nmethods = ['virtual_floor']\n[fuse]\ntimeout = 1\n"
    )
    assert load("capture", CaptureConfig, path, []).rate == 10.0
    negative = load("negative", NegativeConfig, path, [])
    assert (negative.beams, negative.methods) == (90, ("virtual_floor",))
    assert load("fuse", FuseConfig, path, []).timeout == 1.0
    assert load("positive", PositiveConfig, path, []) == PositiveConfig(beams=90)


def test_overrides_win_over_the_file_and_the_last_over_the_first(file):
    path = file("[capture]\nrate = 10\nheight = 0.4\n")
    config = load("capture", CaptureConfig, path, ["capture.rate=20", "capture.rate = 25"])
    assert (config.rate, config.height) == (25.0, 0.4)


def test_a_nested_table_may_be_in_the_file_or_overridden(file):
    path = file('[fuse.inputs.lidar]\nkey = "scan/lidar"\nx = 0.1\n')
    config = load("fuse", FuseConfig, path, ["fuse.inputs.lidar.yaw=-90", "fuse.inputs.lidar.x=0.2"])
    lidar = config.inputs["lidar"]
    assert (lidar.key, lidar.x, lidar.y, lidar.yaw) == ("scan/lidar", 0.2, 0.0, -90.0)
    assert overridden(LIDAR, "fuse.inputs.rear.key=rear").inputs.keys() == {"lidar", "rear"}
    assert overridden('fuse.inputs.lidar={key = "scan/lidar", y = 1}').inputs["lidar"].y == 1.0


@pytest.mark.parametrize(
    ("override", "key", "value"),
    [
        ("capture.compressed=false", "compressed", False),
        ("capture.loop=true", "loop", True),
        ("capture.source=replay", "source", "replay"),
        ('capture.source="replay"', "source", "replay"),
        ("capture.rate=7", "rate", 7.0),
        ("capture.rate=5e-1", "rate", 0.5),
        ("capture.device=3", "device", 3),
        ("capture.range=[1, 4.5]", "range", (1.0, 4.5)),
        ("capture.intrinsics=[525, 525.5, 319.5, 239.5]", "intrinsics", (525.0, 525.5, 319.5, 239.5)),
        ('negative.methods=["virtual_floor"]', "methods", ("virtual_floor",)),
        ("scan.beams=1_000", "beams", 1000),
        ("capture.path=", "path", ""),
        ('capture.path="/a b"', "path", "/a b"),
    ],
)
def test_an_override_is_a_toml_value_or_a_word(override, key, value):
    found = getattr(overridden(override), key)
    assert found == value
    assert type(found) is type(value)


PATHS = [
    "'a'\nb = 3",
    "/data/a b",
    "../x=y=z",
    "/ü/日本",
    "a#b",
    "it's",
    'say "x"',
    "C:\\data",
    "[1",
    "{",
    "a\tb",
    "-1-",
    "a\nb = 3",
]


@pytest.mark.parametrize("path", PATHS)
def test_a_path_needs_no_quotes(path):
    assert overridden(f"capture.path={path}").path == path


@pytest.mark.parametrize("path", ["2024", "1e5", "2024-01-31", "true", "[x]"])
def test_a_folder_may_be_called_like_a_number(path):
    assert overridden(f"capture.path={path}").path == path


@given(st.text(st.characters(exclude_categories=["Cs", "Cc"]), min_size=1).map(lambda name: "/" + name))
def test_any_path_survives_an_override_and_a_dump(path):
    assert overridden(f"capture.path={path}").path == path


CHANGED = {
    "capture": ['capture.path=/data/it\'s "odd"\\=ü\n#', "capture.compressed=false", "capture.range=[0.1, 65]"],
    "negative": ["scan.beams=2", "scan.scan_time=1e-9", 'negative.methods=["virtual_floor"]'],
    "positive": ["positive.robot_height=1e15", "scan.range_max=12345.75"],
    "fuse": [LIDAR, "fuse.inputs.lidar.x=-1e-3", "fuse.inputs.a b.key=x", "fuse.inputs..key=y"],
}


@pytest.mark.parametrize("overrides", [[], *CHANGED.values()], ids=["defaults", *CHANGED])
@pytest.mark.parametrize("service", KINDS)
def test_what_is_dumped_can_be_loaded(service, overrides, file):
    config = load(service, KINDS[service], None, [each for each in overrides if meant_for(service, each)])
    assert load(service, KINDS[service], file(dump({service: config})), []) == config


UNKNOWN_KEYS = ["capture.sorce=x", "negative.height=0.3", "fuse.inputs.lidar.mount=1", "positive.=1", "capture. rate=1"]


@pytest.mark.parametrize("override", UNKNOWN_KEYS)
def test_an_unknown_key_is_named(override):
    key, service = override.split("=")[0].partition(".")[2], override.split(".")[0]
    message = refusal(service, None, override)
    assert key in message
    assert "is not known here" in message


OUT_OF_BOUNDS = """
capture.rate=0 capture.rate=-1 capture.rate=1001 capture.rate=inf capture.rate=nan capture.height=0 capture.height=21
capture.pitch=87 capture.pitch=-87 capture.roll=181 capture.device=-1 capture.device=1.5 capture.source=webcam
capture.x=6 capture.y=-6 capture.yaw=181
capture.range=[0.5] capture.range=[1,2,3] capture.range=0.5 capture.intrinsics=[1,2,3]
capture.intrinsics=[0,1,1,1] capture.range=[inf,1] capture.depth_mode=10bit capture.loop=2 capture.seed=-1
scan.beams=1 scan.beams=20001 scan.beams=64.5 scan.field_of_view=0 scan.field_of_view=180
negative.range_min=-1 scan.range_max=0 scan.scan_time=-1 scan.floor_band=0 scan.floor_band=0.6
negative.methods=[] negative.methods=farthest_point negative.methods=["nearest"] negative.methods={}
positive.robot_height=0 fuse.timeout=0 fuse.timeout=-1 fuse.inputs=5 fuse.inputs.lidar=5 fuse.inputs.lidar.x=1
fuse.inputs.l.key=/scan fuse.inputs.l.key=scan/ fuse.inputs.l.key=a/*/b fuse.inputs.l.key=** fuse.inputs.l.key=a$b
capture.rate=yes capture.rate=[] capture.rate={} capture.rate=1979-05-27 capture.rate=07:32:00 capture.rate=
capture.compressed=maybe capture.compressed=[] fuse.timeout=soon negative.range_min=10 scan.range_max=inf
"""


@pytest.mark.parametrize("override", OUT_OF_BOUNDS.split())
def test_a_bad_value_is_refused_by_its_key(override):
    table, key = override.split("=")[0].split(".")[:2]
    assert refusal(reader(override), None, override).startswith((f"{table}.{key}", f"{table}.range_max"))


@pytest.mark.parametrize(
    ("override", "named"),
    [
        ("negative.range_min=10", "range_max 10.0 is not above range_min 10.0"),
        ("positive.robot_height=0.03", "robot_height 0.03 is not above floor_band 0.03"),
        ('negative.methods=["virtual_floor","virtual_floor"]', "methods: one is named twice"),
        ("fuse.inputs.positive.key=x", "inputs"),
        ("fuse.inputs.negative.key=x", "inputs"),
    ],
)
def test_values_that_contradict_each_other_are_refused(override, named):
    assert named in refusal(override.split(".")[0], None, override)


@pytest.mark.parametrize("service", SHARED["scan"])
@pytest.mark.parametrize("key", ScanConfig.model_fields)
def test_what_services_must_agree_on_has_one_home(service, key, file):
    for refused in (refusal(service, None, f"{service}.{key}=1"), refusal(service, file(f"[{service}]\n{key} = 1"))):
        assert refused == f"{service}.{key}: write scan.{key}, for it has one home"


def test_the_shared_table_has_nothing_else(file):
    assert (
        refusal("negative", None, "scan.range_min=1") == "scan.range_min: write negative.range_min, for it has one home"
    )
    assert refusal("negative", file("[scan]\nbeam = 1")).startswith("scan.beam: is not known here")


def test_every_service_that_has_settings_can_be_run():
    assert set(CONFIGURED) <= set(service_names())


@pytest.mark.parametrize("service", CONFIGURED)
def test_a_service_reads_the_tables_that_its_class_shares(service):
    shared = {table for table, readers in SHARED.items() if service in readers}
    assert set(home_tables(service, config_class(service)).values()) == {service, *shared}


def test_a_refusal_speaks_of_a_configuration_not_of_a_message():
    assert "negative.message" not in refusal("negative", None, "negative.range_min=10")


NO_NUMBERS = ["capture.rate=true", "capture.device=true", "scan.scan_time=false", "capture.range=[true, 4.5]"]


@pytest.mark.parametrize("override", [*NO_NUMBERS, 'capture.rate="30"', "capture.compressed=0.0"])
def test_a_truth_a_number_and_a_text_are_not_the_same(override):
    assert override.split("=")[0] in refusal(reader(override), None, override)


@pytest.mark.parametrize(
    "override",
    ["capture.range=[4.5, 0.5]", "capture.range=[1, 1]", "capture.range=[-1, 4]", "capture.intrinsics=[1, 1, 1, 1]"],
)
def test_a_camera_that_cannot_be_is_refused_before_it_is_used(override):
    assert override.split("=")[0] in refusal("capture", None, override)


@pytest.mark.parametrize(
    ("override", "named"),
    [
        ("capture.range=[500, 4500]", "is it in millimetres?"),
        (f"capture.frame={'x' * 257}", "at most 256 characters"),
    ],
)
def test_a_camera_that_no_receiver_takes_is_refused_with_the_reason(override, named):
    assert named in refusal("capture", None, override)


@pytest.mark.parametrize("key", ["scan/fused", "scan/safe", "camera/depth", "status/fuse"])
def test_an_extra_input_is_a_scan_of_somebody_else(key):
    assert "fuse.inputs" in refusal("fuse", None, f"fuse.inputs.lidar.key={key}")


BAD_OVERRIDES = ["rate=3", "capture", "capture=5", "", "=", ".", "capture.rate", "nonsense.rate=3", "scan.beams=9"]


@pytest.mark.parametrize("override", BAD_OVERRIDES)
def test_what_is_no_override_of_this_service_is_refused(override):
    assert refusal("capture", None, override).startswith(f"--set {override}: ")


def test_an_override_below_a_value_is_refused(file):
    assert "rate is no table" in refusal("capture", file("[capture]\nrate = 5\n"), "capture.rate.x=1")
    assert "capture.rate" in refusal("capture", None, "capture.rate.x=1")
