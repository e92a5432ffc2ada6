"""An exam for the diagnosis: cases drawn by seed, what an answer is worth, tables and figures of many."""
