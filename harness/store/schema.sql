-- The results database. Measurements (run, metric, control, recording, event, frame) are only ever added; a point that is measured again gets
-- further runs, and `current_run` shows the newest of each repeat. JSON columns hold JSON text.

CREATE TABLE machine (
    id          INTEGER PRIMARY KEY,
    fingerprint TEXT NOT NULL UNIQUE,
    facts       TEXT NOT NULL               -- JSON
);

CREATE TABLE sweep (
    id        INTEGER PRIMARY KEY,
    started   TEXT NOT NULL,                -- ISO 8601, UTC
    finished  TEXT,                         -- NULL while it goes on, and for ever when it was killed
    command   TEXT NOT NULL,
    commit_id TEXT,
    version   TEXT NOT NULL,                -- of harness
    machine   INTEGER NOT NULL REFERENCES machine,
    packages  TEXT NOT NULL                 -- JSON, {name: version}
);

CREATE TABLE experiment (
    id            INTEGER PRIMARY KEY,
    name          TEXT NOT NULL UNIQUE,
    title         TEXT NOT NULL,
    question      TEXT,
    source        TEXT NOT NULL,            -- the YAML as it was written
    specification TEXT NOT NULL,            -- JSON, {expect, claims, published, report, swept, measure, lacking}
    sweep         INTEGER NOT NULL REFERENCES sweep     -- the newest that listed it
);

CREATE TABLE point (
    id         INTEGER PRIMARY KEY,
    key        TEXT NOT NULL UNIQUE,        -- hash of all that the measurement depends on
    parameters TEXT NOT NULL,               -- JSON, {leaf: value}, derived ones included
    plan       TEXT NOT NULL                -- JSON, {stages: [{name, kept, why}], warnings: [text]}; {} before its first run
);

-- The points an experiment has now; replaced whenever it is swept.
CREATE TABLE experiment_point (
    experiment INTEGER NOT NULL REFERENCES experiment,
    point      INTEGER NOT NULL REFERENCES point,
    place      INTEGER NOT NULL,
    PRIMARY KEY (experiment, place),
    UNIQUE (experiment, point)
);

CREATE TABLE run (
    id           INTEGER PRIMARY KEY,
    point        INTEGER NOT NULL REFERENCES point,
    repeat       INTEGER NOT NULL CHECK (repeat >= 0),
    sweep        INTEGER NOT NULL REFERENCES sweep,
    status       TEXT NOT NULL CHECK (status IN ('ok', 'failed', 'timeout', 'memory', 'crashed', 'rejected')),
    reason       TEXT,
    stderr       TEXT,                      -- its tail
    started      TEXT,                      -- ISO 8601, UTC
    timing_grade INTEGER NOT NULL CHECK (timing_grade IN (0, 1)),
    machine      INTEGER NOT NULL REFERENCES machine,   -- where it ran; on a cluster not that of its sweep
    conditions   TEXT NOT NULL,             -- JSON, {name: value}: load, steal, frequency … that it met
    UNIQUE (point, repeat, sweep)
);

-- The run of a point and repeat once more: how far two equal runs differ is the noise of the machine.
CREATE TABLE control (
    point   INTEGER NOT NULL REFERENCES point,
    repeat  INTEGER NOT NULL CHECK (repeat >= 0),
    sweep   INTEGER NOT NULL REFERENCES sweep,
    machine INTEGER NOT NULL REFERENCES machine,
    status  TEXT NOT NULL,
    metrics TEXT NOT NULL,                  -- JSON, {name: value}: its clocks
    PRIMARY KEY (point, repeat, sweep)
);

CREATE TABLE metric (
    run   INTEGER NOT NULL REFERENCES run,
    name  TEXT NOT NULL,
    value REAL,                             -- NULL: measured, and not a number
    unit  TEXT NOT NULL,
    PRIMARY KEY (run, name)
);

CREATE TABLE event (
    run    INTEGER NOT NULL REFERENCES run,
    place  INTEGER NOT NULL,
    time   REAL NOT NULL,                   -- s
    kind   TEXT NOT NULL CHECK (kind IN ('pair', 'wall')),
    first  INTEGER NOT NULL,
    second INTEGER,                         -- NULL for a wall
    wall   TEXT,                            -- NULL for a pair
    PRIMARY KEY (run, place)
) WITHOUT ROWID;

-- The moments at which bodies begin a straight leg; all of them do at time 0.
CREATE TABLE frame (
    run   INTEGER NOT NULL REFERENCES run,
    place INTEGER NOT NULL,
    time  REAL NOT NULL,                    -- s
    data  BLOB NOT NULL,                    -- a row a body whose velocity is new: number, position x y z, velocity x y z; of recorded poses quaternion w x y z, spin x y z too
    PRIMARY KEY (run, place)
);

-- What a replay shows, of a run whose scene was flown once more for it; its hits are in `event`, its legs in `frame`.
CREATE TABLE recording (
    run    INTEGER PRIMARY KEY REFERENCES run,
    facts  TEXT NOT NULL,                   -- JSON, {shape, duration, dt, half_box, turning_legs}; of several meshes {meshes: digests, mesh_of} too
    bodies BLOB NOT NULL,                   -- little-endian doubles, a row a body: size, quaternion w x y z, spin x y z
    mesh   TEXT REFERENCES mesh             -- the first of several; NULL for spheres
);

CREATE TABLE mesh (
    digest   TEXT PRIMARY KEY,
    name     TEXT NOT NULL,
    vertices BLOB NOT NULL,                 -- little-endian doubles, x y z; the bounding sphere has diameter 1
    faces    BLOB NOT NULL                  -- little-endian 32-bit numbers of vertices, three a face
);

CREATE TABLE expectation (
    experiment INTEGER NOT NULL REFERENCES experiment,
    place      INTEGER NOT NULL,
    sweep      INTEGER NOT NULL REFERENCES sweep,
    criterion  TEXT NOT NULL,               -- JSON, the row of the experiment file
    verdict    TEXT NOT NULL CHECK (verdict IN ('holds', 'fails', 'undecided')),
    statement  TEXT NOT NULL,
    detail     TEXT NOT NULL,               -- JSON
    PRIMARY KEY (experiment, sweep, place)
);

CREATE TABLE claim (
    experiment INTEGER NOT NULL REFERENCES experiment,
    place      INTEGER NOT NULL,
    sweep      INTEGER NOT NULL REFERENCES sweep,
    criterion  TEXT NOT NULL,
    verdict    TEXT NOT NULL CHECK (verdict IN ('holds', 'fails', 'undecided')),
    statement  TEXT NOT NULL,
    detail     TEXT NOT NULL,
    PRIMARY KEY (experiment, sweep, place)
);

-- What `harness compare`, or a sweep, found of two backends on the poses of an experiment; the newest of each two counts.
CREATE TABLE comparison (
    id         INTEGER PRIMARY KEY,
    experiment TEXT NOT NULL,               -- its name; it need not have been swept
    first      TEXT NOT NULL,
    second     TEXT NOT NULL,               -- the backends
    made       TEXT NOT NULL,               -- ISO 8601, UTC
    command    TEXT NOT NULL,
    key        TEXT NOT NULL,               -- hash of all that it depends on
    document   TEXT NOT NULL                -- JSON: as `--json` prints it, and the cases as a page shows them
);

CREATE VIEW current_run AS
    SELECT * FROM run WHERE id IN (SELECT max(id) FROM run GROUP BY point, repeat);
