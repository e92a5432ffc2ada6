"""A second simulator of the reference leg, with motions, sizes and cases of its own.

It shares no code with the virtual leg of `workbench.rigs` nor with what explains: a habit that one simulator and
the diagnosis have in common is no habit of the other.
"""
