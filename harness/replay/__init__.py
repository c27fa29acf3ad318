"""Replays: the still picture of a recording (`still`), its compact form (`document`), its page (`page`)."""
