"""The codes that compiled code stores and compares."""

from __future__ import annotations

from enum import IntEnum


class Event(IntEnum):
    """What the scheduled event of a body is. Of several at one time, the lowest comes first."""

    SEARCH = -1  # for the contact of a shape inside its bounding sphere
    UNSCHEDULED = 0  # the body's next event is not known yet
    PAIR = 1
    WALL = 2
    CROSSING = 3  # into the next cell
    RENEWAL = 4  # of the neighbour list, or of the cells of finer grids at which it is registered
    NOTHING = 5


class NeighbourSearch(IntEnum):
    """Where the candidates for pair events come from."""

    CELLS = 0
    LISTS = 1


class ResponseCode(IntEnum):
    """What a touch does."""

    NONE = 0
    REFLECT = 1
    ELASTIC = 2


class Phase(IntEnum):
    """What a window, on a body or on a wall, waits for."""

    APART = 0  # a search for the contact of bodies that are apart
    NEAR = 1  # a closer one, where their hulls are near each other
    UNSURE = 2  # a search for the contact of bodies whose spheres overlap at first sight: they may be touching
    TOUCHING = 3  # a search for the end of a contact
    PARTING = 4  # that end
    DUE = 5  # the hit that a search has found


class Task(IntEnum):
    """What a body must do after an event."""

    PREDICT = 0  # look for its next event among all candidates
    EXTEND = 1  # look only at the candidates that are new to it
    KEEP = 2  # nothing: its candidates stand
    GIVE_UP = 3  # a neighbour list is full


class CellTask(IntEnum):
    """What is done at a cell that a larger sphere is near."""

    GATHER = 0  # list the spheres in it
    REGISTER = 1  # add the larger sphere to those near it
    REMOVE = 2  # take it away from them


class Stop(IntEnum):
    """Why an event loop does not take its next event."""

    NOT = 0  # it does
    REACHED = 1  # the end of the flight
    SPENT = 2  # the budget of hits
    FULL = 3  # the event log
    NO_ROOM = 4  # for neighbours, or for windows
    REBASE = 5  # times must be counted from a new base first
    REORDER = 6  # bodies must be put in order in memory first
