"""Makes a recording of any table or log; the meaning of its columns is found or asked."""

from .by_weight import by_weight
from .files import open_table
from .import_table import import_table, said_by
from .proposal import Answers, Proposal, Question
from .propose import propose
from .questions import told
from .table import Table
from .write import complete, write

__all__ = [
    "Answers", "Proposal", "Question", "Table", "by_weight", "complete", "import_table", "open_table",
    "propose", "said_by", "told", "write",
]  # fmt: skip
