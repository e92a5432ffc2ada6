"""An exam of hidden effects: which physical effect does a robot's model lack, where, and how large?

`read_case` and `Answer` are all that a solver needs; `workbench_exam.plants` makes the cases.
"""
