"""Compile what most tests run, once, before many processes would do it at a time: python -m tests.compile"""

from cliffscan.common.contract.depth_codec import LEVELS
from cliffscan.common.contract.messages import DepthImage
from cliffscan.compile import compile_perception
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.simulator.camera import SimulatedKinect
from tests import scenes

CAMERA = scenes.camera()


def compile_kernels():
    """Run each kernel of perception once, from the files where it was compiled before."""
    compile_perception()
    for world in ("landing", "office"):  # edges, and things that stand on the floor
        depth = SimulatedKinect(world, CAMERA).frame()
        FloorTracker(CAMERA.floor).update(depth, CAMERA)
        image = DepthImage.pack(0, 0, "camera", depth, CAMERA, LEVELS)
        for sent in (image, DepthImage.decode(image.encode())):
            for settings in (Settings(), Settings.of_profile("paper")):
                perceive(sent, settings)


if __name__ == "__main__":
    compile_kernels()
