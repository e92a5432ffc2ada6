"""The catalogue of physical effects, one small file each, and how a model is built from them."""

from . import kinds
from .base import Effect, FrfSignature, SignalStage, model_value
from .base_compliance import BASE_JOINT
from .build import Plant, build, compile_plant
from .catalogue import EFFECTS, contains, effect_named, giving_way, places
from .chain import Build, FlankTerm, FrictionTerm, HysteresisTerm, SensorErrors, TorqueChain, TorqueTerm
from .check import axis_units, check_effect, load_model
from .compliance import Compliance
from .contact import OnGround
from .corrected import OfBody, own_dry_friction
from .flexible import link_inertia, rotor_inertia
from .friction_constraint import rigid_in_steps, tendon_leads
from .ground import feet_of, plate_columns, settle_contacts
from .ground_friction import FEWEST_SLIPS, ratio_in_slip
from .into_file import Change, InFile, inertials_into_file, into_file, open_text
from .lag import follow, heat
from .law import LONGEST, Law, call_law, law
from .link_regressor import link_regressor
from .links import Link, link_of, link_with
from .motion import Contact, Line, LinkMotion, Motion, held, torque_bounds
from .parameter import Parameter, Parameters, Values
from .passage import Passage
from .presliding_hysteresis import wound
from .response import Response, smooth_sign
from .setting import SETTINGS
from .settled import with_settled
from .springs import Springs
from .stiffness import tendon_row
from .structural import Structural
from .structure import crank_of, is_parallelogram

__all__ = [
    "BASE_JOINT",
    "EFFECTS",
    "FEWEST_SLIPS",
    "LONGEST",
    "SETTINGS",
    "Build",
    "Change",
    "Compliance",
    "Contact",
    "Effect",
    "FlankTerm",
    "FrfSignature",
    "FrictionTerm",
    "HysteresisTerm",
    "InFile",
    "Law",
    "Line",
    "Link",
    "LinkMotion",
    "Motion",
    "OfBody",
    "OnGround",
    "Parameter",
    "Parameters",
    "Passage",
    "Plant",
    "Response",
    "SensorErrors",
    "SignalStage",
    "Springs",
    "Structural",
    "TorqueChain",
    "TorqueTerm",
    "Values",
    "axis_units",
    "build",
    "call_law",
    "check_effect",
    "compile_plant",
    "contains",
    "crank_of",
    "effect_named",
    "feet_of",
    "follow",
    "giving_way",
    "heat",
    "held",
    "inertials_into_file",
    "into_file",
    "is_parallelogram",
    "kinds",
    "law",
    "link_inertia",
    "link_of",
    "link_regressor",
    "link_with",
    "load_model",
    "model_value",
    "open_text",
    "own_dry_friction",
    "places",
    "plate_columns",
    "ratio_in_slip",
    "rigid_in_steps",
    "rotor_inertia",
    "settle_contacts",
    "smooth_sign",
    "tendon_leads",
    "tendon_row",
    "torque_bounds",
    "with_settled",
    "wound",
]
