"""What simulators other than MuJoCo 4 keep of a normalised file, and the names of what is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from workbench.core import InputError

from .urdf_writer import ROUNDING, urdf_text

_DELAY = ("delay", "interp", "nsample")


@dataclass(frozen=True)
class Fitted:
    """A file for one simulator.

    Attributes:
        text: of the file.
        lost: what the simulator does not have, each with its number.
        reads: which versions read it.
        advice: what to do about the rest, in lines; empty where nothing is left to do.
    """

    text: str
    lost: tuple[str, ...]
    reads: str
    advice: tuple[str, ...] = ()


def for_target(xml: str, target: str) -> Fitted:
    """Return a normalised MJCF as the other simulator reads it, and what it loses.

    Args:
        xml: of `NormalisedTree`, all of it.
        target: name in `TARGETS`.

    Raises:
        InputError: no such target, or a file that it cannot have at all.
    """
    if target not in TARGETS:
        raise InputError(f"no target is called '{target}'", remedy=f"choose one of {', '.join(TARGETS)}")
    return TARGETS[target](xml)


def _mujoco(xml: str) -> Fitted:
    return Fitted(xml, (), "MuJoCo 4.0")


def _mujoco3(xml: str) -> Fitted:
    root = _parsed(xml)
    lost = _cut(root)
    tendons = any(each.get("armature") for kind in ("fixed", "spatial") for each in root.iter(kind))
    reads = "MuJoCo 3.3.1 and later, for its inertia on tendons" if tendons else "MuJoCo 3"
    advice = ("Delay each torque in your own loop, by the time stated here.",) if lost else ()
    return Fitted(_written(root), tuple(lost), reads, advice)


def _mjlab(xml: str) -> Fitted:
    root = _parsed(xml)
    motors = [*root.iter("motor"), *root.iter("general")]
    delays = {each.get("name", ""): float(each.get("delay", 0.0)) for each in motors}
    lost = _cut(root)
    option = root.find("option")
    for key in ("integrator", "timestep"):
        value = option.get(key) if option is not None else None
        if value:
            lost.append(f"{key} {value}: mjlab's own configuration sets it")
    own = " and ".join(sorted({_kind(each) for each in motors}))
    late = sorted({delay for delay in delays.values() if delay})
    advice = [
        f"Motors act on {own}, which have J^T in them: drive torque = J^-T joint torque. In a robot:",
        "  from mjlab.actuator import DelayedActuatorCfg, XmlMotorActuatorCfg",
        f"  motors = XmlMotorActuatorCfg(target_names_expr={tuple(delays)!r})",
    ]
    if late:
        advice += [
            f"  lag = round({late[-1]:g} / timestep)  # physics steps",
            '  late = DelayedActuatorCfg(base_cfg=motors, delay_target="effort", delay_min_lag=lag, '
            "delay_max_lag=lag)",
        ]
    advice += [
        "  # at each step, of joint angles q, speeds v and targets q_ref:",
        "  tau_joint = kp * (q_ref - q) - kd * v",
        _mapped(root),
        "  robot.set_joint_effort_target(tau_drive)",
    ]
    return Fitted(_written(root), tuple(lost), "after mjlab's documentation; not tested here", tuple(advice))


def _mapped(root: ElementTree.Element) -> str:
    """Return the line that maps torques of joints to drives."""
    if next(root.iter("spatial"), None) is not None:
        return "  tau_drive = torch.linalg.solve(J.mT, tau_joint)  # J: the drives' rows of ten_J, each step"
    return (
        "  tau_drive = tau_joint @ inv_J  # inv_J = torch.linalg.inv(J), of the model file's [transmission]"
    )


def _newton(xml: str) -> Fitted:
    root = _parsed(xml)
    lost = _cut(root)
    for tendon in (each for kind in ("fixed", "spatial") for each in root.iter(kind) if each.get("armature")):
        armature = float(tendon.get("armature", 0.0))
        if abs(armature) > ROUNDING * _inertia(root):
            lost.append(
                f"tendon {tendon.get('name')}: armature {armature:.6g}, in solvers other than MuJoCo's"
            )
    return Fitted(_written(root), tuple(lost), "Newton 1.8; not tested here")


def _urdf(xml: str) -> Fitted:
    root = _parsed(xml)
    text, lost = urdf_text(xml)
    return Fitted(text, (*_without_yield(root), *_linear(root), *lost), "any URDF reader")


#: Simulators by name.
TARGETS: dict[str, Callable[[str], Fitted]] = {
    "mujoco": _mujoco, "mujoco3": _mujoco3, "mjlab": _mjlab, "newton": _newton, "urdf": _urdf,
}  # fmt: skip


def _parsed(xml: str) -> ElementTree.Element:
    keep = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    return ElementTree.fromstring(xml, keep)


def _written(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _actuators(root: ElementTree.Element) -> list[ElementTree.Element]:
    return [each for holder in root.findall("actuator") for each in holder]


def _cut(root: ElementTree.Element) -> list[str]:
    """Remove what only MuJoCo 4 has; return a line for each thing removed."""
    return [*_without_delay(root), *_without_yield(root), *_linear(root)]


def _without_delay(root: ElementTree.Element) -> list[str]:
    lost = []
    for motor in _actuators(root):
        if float(motor.get("delay", 0.0)):
            lost.append(f"motor {motor.get('name')}: delay {float(motor.get('delay', 0.0)):g} s")
        for key in _DELAY:
            motor.attrib.pop(key, None)
    return lost


def _without_yield(root: ElementTree.Element) -> list[str]:
    """Remove the hysteresis of springs; return a line for each."""
    lost = []
    for each in _elements(root):
        text = each.attrib.pop("springyield", None)
        values = [float(x) for x in (text or "").split()]
        if any(values):
            lost.append(f"{_called(each)}: hysteresis (springyield {_short(values)})")
    return lost


def _linear(root: ElementTree.Element) -> list[str]:
    """Reduce polynomial damping and stiffness to the linear term; return a line for each.

    A term that is next to nothing beside the weight is what a fit or a sum leaves, and no loss.
    """
    lost, least = [], ROUNDING * _weight(root)
    for each in _elements(root):
        for key in ("damping", "stiffness"):
            first, *more = each.get(key, "").split() or [""]
            if more:
                each.set(key, first)
                terms = [x if abs(x) > least else 0.0 for x in map(float, more)]
                if any(terms):
                    lost.append(f"{_called(each)}: {key} beyond the linear ({_short(terms)})")
    return lost


def _weight(root: ElementTree.Element) -> float:
    """Torque [N m] of all masses at the end of all links stretched out: what torques are small beside."""
    masses = sum(float(each.get("mass", 0.0)) for each in root.iter("inertial"))
    return 9.81 * masses * _reach(root)


def _inertia(root: ElementTree.Element) -> float:
    """Inertia [kg m^2] of the lightest link that has one, about its centre: what rotors are small beside."""
    found = [
        max(map(float, (each.get("fullinertia") or each.get("diaginertia") or "0").split()))
        for each in root.iter("inertial")
    ]
    return min((each for each in found if each > 0.0), default=0.0)


def _reach(root: ElementTree.Element) -> float:
    """Sum of the links' lengths [m]."""
    return sum(
        max((abs(float(x)) for x in each.get("pos", "0").split()), default=0.0)
        for kind in ("body", "inertial")
        for each in root.iter(kind)
    )


def _called(each: ElementTree.Element) -> str:
    kind = "tendon" if each.tag in ("fixed", "spatial") else each.tag
    return f"{kind} {each.get('name')}"


def _short(values: Sequence[float]) -> str:
    return " ".join(f"{value:.6g}" for value in values)


def _elements(root: ElementTree.Element) -> list[ElementTree.Element]:
    """Return all elements without comments."""
    return [each for each in root.iter() if isinstance(each.tag, str)]


def _kind(motor: ElementTree.Element) -> str:
    return "tendons" if motor.get("tendon") else "joints"
