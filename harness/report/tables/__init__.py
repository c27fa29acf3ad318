"""The tables of an experiment's page, from its arrangement."""
