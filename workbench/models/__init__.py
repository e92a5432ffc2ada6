"""Models: machines as the user believes them to be, read from TOML or MJCF and built for each engine."""

from .alike import alike_axes
from .contacts import base_contacts, machine_bodies
from .engine import silence, stop_clock, warned
from .file_number import BodyNumbers, Inertial, JointNumber, inertial_frame
from .floating import BASE_AXES
from .mjcf import check_mjcf
from .mjcf_text import MjcfText, differ
from .model import VARIANTS, Actuators, AppliedEffect, Crank, Ground, Linkage, Model
from .own_friction import (
    NO_FRICTION,
    friction_lead,
    friction_leads,
    own_constraints,
    own_friction,
    take_friction,
)
from .paths import find_model, is_named_model, packaged_robot
from .read import read_model
from .schema import MOST
from .serial import (
    Placement,
    axis_tendon,
    base_spec,
    drive_tendons,
    free_joints,
    joint_kinds,
    limits_left_out,
    rotors,
    springs,
    turned_joint,
)
from .servos import Servos, servos_of
from .spec import load_mjcf, load_tree, load_with_loops
from .stated_effects import structural_effect
from .urdf import is_urdf
from .urdf_text import UrdfText
from .write import linkage_table, model_text, write_model

silence()
stop_clock()

__all__ = [
    "BASE_AXES", "MOST", "NO_FRICTION", "VARIANTS", "Actuators", "AppliedEffect", "BodyNumbers", "Crank",
    "Ground", "Inertial", "JointNumber", "Linkage", "MjcfText", "Model", "Placement", "Servos",
    "UrdfText", "alike_axes", "axis_tendon", "base_contacts", "base_spec", "check_mjcf", "differ",
    "drive_tendons", "find_model", "free_joints", "friction_lead", "friction_leads", "inertial_frame",
    "is_named_model", "is_urdf", "joint_kinds", "limits_left_out", "linkage_table", "load_mjcf",
    "load_tree", "load_with_loops", "machine_bodies", "model_text", "own_constraints", "own_friction",
    "packaged_robot", "read_model", "rotors", "servos_of", "springs", "structural_effect",
    "take_friction", "turned_joint", "warned", "write_model",
]  # fmt: skip
