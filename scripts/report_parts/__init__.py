"""The parts of scripts/report: tables are read, compared, drawn and set on one page."""
