"""The ground of the virtual quadruped damps by its stiffness times Drake's step more than it states."""

from transfer_drop import misses


def test_the_simulation_with_drake_s_own_damping_is_nearest() -> None:
    found = misses()
    assert min(found, key=found.__getitem__) == 200.0  # 150 N s/m, and 100 kN/m times 0.5 ms
    assert found[200.0] < 0.5 * found[150.0]
