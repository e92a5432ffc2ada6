"""The one list of tests that `make test` leaves to `make test-all`: folder, file or test, and why."""

from __future__ import annotations

#: What needs more than requirements.lock -> the extra that brings it.
EXTRA = {
    "training": "training",
    "analyses/test_transfer_jump.py": "training",
    "analyses/test_transfer_worlds.py": "training",
    "cli/test_bad_input.py::test_what_cannot_be_read_ends_in_one_line[export 0]": "training",
    "cli/test_compare_gait.py": "training",
    "cli/test_matrix.py": "training",
    "cli/test_train.py": "training",
    "core/test_drive_map.py": "training",
    "fleet/test_run.py::test_a_cluster_loses_nothing_either": "ray",
    "proposing/test_text_and_json.py::test_tensors_are_read_and_nothing_is_run": "training",
    "report/test_rerun_file.py": "rerun",
}

_WHOLE = "whole diagnoses, some of them of machines with many axes"
#: What takes more than some seconds of CPU time -> what it does in them.
SLOW = {
    "analyses": "whole studies, small",
    "benchmarks": "whole benchmarks, small",
    "cli/test_cli.py::test_the_loop_from_compare_to_compare": "a whole improvement, by its commands",
    "cli/test_dry_run.py": "runs on virtual hardware, and their recordings explained",
    "cli/test_reported_logs.py": _WHOLE,
    "cli/test_reproducible.py": "a demo and an improvement, twice each",
    "deployment/test_fault_table.py": "every fault of the table on virtual hardware, in each protocol",
    "deployment/test_record_attacked.py": "a run is recorded again for each call to the disk that fails",
    "diagnosis/adequacy": _WHOLE,
    "diagnosis/evidence/test_next_experiment.py": _WHOLE,
    "diagnosis/moves/test_joint_fit.py": _WHOLE,
    "diagnosis/moves/test_joint_solution.py": _WHOLE,
    "diagnosis/screening/test_identifiability.py": _WHOLE,
    "diagnosis/test_carried.py": _WHOLE,
    "diagnosis/test_clamped.py": _WHOLE,
    "diagnosis/test_emps.py": _WHOLE,
    "diagnosis/test_first_link.py": _WHOLE,
    "diagnosis/test_floating.py": _WHOLE,
    "diagnosis/test_free_swing.py": _WHOLE,
    "diagnosis/fitting/test_free_starts.py": "a fit on the ground, twice",
    "diagnosis/test_grounded.py": _WHOLE,
    "diagnosis/test_harmonics.py": _WHOLE,
    "diagnosis/test_own_friction.py": _WHOLE,
    "diagnosis/test_rotor.py": _WHOLE,
    "diagnosis/test_rounds.py": _WHOLE,
    "diagnosis/test_search.py": _WHOLE,
    "diagnosis/test_two_mass.py": _WHOLE,
    "diagnosis/test_unknown_loop.py": _WHOLE,
    "diagnosis/test_unlogged_delay.py": _WHOLE,
    "diagnosis/test_unstable_loop.py": _WHOLE,
    "diagnosis/test_ways.py": _WHOLE,
    "diagnosis/test_work_budget.py": _WHOLE,
    "diagnosis/test_wrong_numbers.py": _WHOLE,
    "docs/test_commands.py": "every command of the documentation",
    "docs/test_diagnosis_numbers.py": "the numbers of the documentation, made anew",
    "docs/test_site.py": "the documentation as a site",
    "fleet/test_run.py::test_workers_that_are_killed_lose_nothing": "a fleet, diagnosed twice",
    "importing/test_hardware.py": "whole demos of machines from files",
    "notebooks": "every notebook",
    "ui/test_browser.py": "the live workbench in a browser",
}
