"""A second simulator of the reference leg, with motions, sizes and cases of its own.

It shares no code with the virtual leg of `workbench.rigs` nor with what explains: what the diagnosis owes
to a habit of one simulator, the other shows.
"""
