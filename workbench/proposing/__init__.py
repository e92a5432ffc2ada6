"""Any table or log that an engineer has, made a recording: what its columns are is found or asked."""

from .files import open_table
from .proposal import Answers, Assumption, Proposal, Question
from .propose import propose
from .table import Table
from .write import complete, write

__all__ = [
    "Answers",
    "Assumption",
    "Proposal",
    "Question",
    "Table",
    "complete",
    "open_table",
    "propose",
    "write",
]
