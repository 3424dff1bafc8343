"""The dataset's SQLite schema: plain tables that any SQLite shell can read, and the migrations between its versions.

A dataset is a folder: `dataset.sqlite`, `depth/*.png` (16-bit, 0.1 mm units, 0 is invalid) and `objects/*.npz`.

How it hangs together: objects have stable poses; a scene places one object (or more) under a camera and has one depth
file; grasps belong to a scene and are numbered in it (grid grasps count from 0, people's own get numbers from their
content, at or above `HAND_MADE`); attempts belong to a grasp, and name the label event that asked for them unless they
were made with the scene. Label events are append-only, a trigger sees to it. `samples` is the materialised present: one
row a grasp with everything that lists are filtered and sorted by, and it can always be rebuilt from the other tables.
"""

APPLICATION_ID = 0x47574453
"""`PRAGMA application_id` of a dataset ("GWDS"): tells it from other people's SQLite files."""

HAND_MADE = 1 << 32
"""Grasp numbers from here on belong to grasps that people made."""

_VERSION_1 = """
CREATE TABLE meta (
    key TEXT PRIMARY KEY,
    value TEXT NOT NULL                     -- JSON
) STRICT, WITHOUT ROWID;

CREATE TABLE cameras (
    id INTEGER PRIMARY KEY,
    digest TEXT NOT NULL UNIQUE,
    settings TEXT NOT NULL                  -- JSON with the keys of a camera file
) STRICT;

CREATE TABLE objects (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    category TEXT NOT NULL,
    split TEXT NOT NULL CHECK (split IN ('train', 'validation', 'test')),
    digest TEXT NOT NULL,                   -- of geometry and mass
    file TEXT NOT NULL UNIQUE,              -- in objects/
    sha256 TEXT NOT NULL,                   -- of that file
    source TEXT NOT NULL                    -- for people
) STRICT;

CREATE TABLE poses (
    object INTEGER NOT NULL REFERENCES objects (id),
    number INTEGER NOT NULL,                -- 0 is the most probable
    pose TEXT NOT NULL,                     -- JSON, 4x4 row by row, resting on z = 0
    probability REAL NOT NULL,
    PRIMARY KEY (object, number)
) STRICT, WITHOUT ROWID;

CREATE TABLE scenes (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    object INTEGER NOT NULL REFERENCES objects (id),
    split TEXT NOT NULL CHECK (split IN ('train', 'validation', 'test')),
    pose INTEGER NOT NULL,
    seed INTEGER NOT NULL,
    camera INTEGER NOT NULL REFERENCES cameras (id),
    file TEXT NOT NULL UNIQUE,              -- in depth/
    sha256 TEXT NOT NULL,                   -- of that file; other copies may be compressed otherwise
    pixels TEXT NOT NULL,                   -- SHA-256 of the decoded 16-bit pixels
    digest TEXT NOT NULL,                   -- of everything made with the scene; see content.scene_digest
    seconds REAL NOT NULL,                  -- of computing; no part of the digest
    added INTEGER NOT NULL                  -- Unix time, ms; no part of the digest
) STRICT;
CREATE INDEX scenes_object ON scenes (object);
CREATE INDEX scenes_split ON scenes (split, name);

CREATE TABLE placements (
    scene INTEGER NOT NULL REFERENCES scenes (id),
    slot INTEGER NOT NULL,
    object INTEGER NOT NULL REFERENCES objects (id),
    pose TEXT NOT NULL,                     -- JSON, world_from_object, 4x4 row by row
    PRIMARY KEY (scene, slot)
) STRICT, WITHOUT ROWID;

CREATE TABLE people (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    added INTEGER NOT NULL                  -- Unix time, ms
) STRICT;

CREATE TABLE grasps (
    id INTEGER PRIMARY KEY,
    scene INTEGER NOT NULL REFERENCES scenes (id),
    number INTEGER NOT NULL,                -- in the scene; people's own from 2^32 on
    x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,      -- p, world, m
    angle REAL NOT NULL,                    -- of the closing axis, rad in [-pi/2, pi/2)
    width REAL NOT NULL,                    -- opening, m
    origin TEXT NOT NULL CHECK (origin IN ('grid', 'person', 'planner', 'import')),
    person INTEGER REFERENCES people (id),
    parent INTEGER REFERENCES grasps (id),  -- the grasp that this one was edited from
    added INTEGER,                          -- Unix time, ms, of grasps added later
    UNIQUE (scene, number)
) STRICT;
CREATE INDEX grasps_added ON grasps (origin, id) WHERE origin <> 'grid';

CREATE TABLE label_events (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    uid TEXT NOT NULL UNIQUE,               -- the same event keeps it in every copy of the dataset
    grasp INTEGER NOT NULL REFERENCES grasps (id),
    at INTEGER NOT NULL,                    -- Unix time, ms
    person INTEGER REFERENCES people (id),  -- none for physics alone
    source TEXT NOT NULL CHECK (source IN ('human', 'dart')),
    kind TEXT NOT NULL CHECK (kind IN
        ('value', 'unsure', 'exclude', 'flag', 'unflag', 'note', 'attempts', 'opinion', 'revert')),
    value REAL CHECK (value BETWEEN 0 AND 1),
    old_value REAL,                         -- the label before; null where the sample was left out
    new_value REAL,                         -- the label after
    reason TEXT NOT NULL,
    note TEXT NOT NULL DEFAULT '',
    reverts INTEGER REFERENCES label_events (id),
    batch TEXT,                             -- shared by the events of one bulk action
    details TEXT NOT NULL DEFAULT '{}',     -- JSON: seed and physics of attempts, what was hidden, ...
    CHECK ((kind = 'value') <= (value IS NOT NULL)),
    CHECK ((kind = 'revert') = (reverts IS NOT NULL)),
    CHECK ((source = 'human') <= (person IS NOT NULL))
) STRICT;
CREATE INDEX label_events_grasp ON label_events (grasp, id);
CREATE INDEX label_events_person ON label_events (person, id);
CREATE INDEX label_events_batch ON label_events (batch) WHERE batch IS NOT NULL;
CREATE TRIGGER label_events_stay BEFORE UPDATE ON label_events
BEGIN SELECT RAISE(ABORT, 'label events are append-only: add another event'); END;
CREATE TRIGGER label_events_keep BEFORE DELETE ON label_events
BEGIN SELECT RAISE(ABORT, 'label events are append-only: add a revert event'); END;

CREATE VIRTUAL TABLE notes USING fts5 (note, content = 'label_events', content_rowid = 'id');
CREATE TRIGGER label_events_noted AFTER INSERT ON label_events WHEN new.note <> ''
BEGIN INSERT INTO notes (rowid, note) VALUES (new.id, new.note); END;

CREATE TABLE attempts (
    grasp INTEGER NOT NULL REFERENCES grasps (id),
    number INTEGER NOT NULL,
    outcome TEXT NOT NULL CHECK (outcome IN ('SUCCESS', 'COLLISION', 'MISSED', 'SLIPPED', 'UNSTABLE')),
    seed INTEGER NOT NULL,
    x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL, angle REAL NOT NULL,     -- executed pose, m and rad
    dynamic INTEGER NOT NULL CHECK (dynamic IN (0, 1)),     -- the engine was needed
    redraws INTEGER NOT NULL,
    comfort_m REAL, comfort_rad REAL,       -- how far the object moved in the gripper
    evidence TEXT,                          -- JSON, of dynamic attempts
    event INTEGER REFERENCES label_events (id),     -- who asked for it; null for those made with the scene
    PRIMARY KEY (grasp, number)
) STRICT, WITHOUT ROWID;

CREATE TABLE views (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    query TEXT NOT NULL,                    -- JSON
    person INTEGER REFERENCES people (id),
    changed INTEGER NOT NULL                -- Unix time, ms
) STRICT;

CREATE TABLE weights (
    id INTEGER PRIMARY KEY,
    digest TEXT NOT NULL UNIQUE,
    name TEXT NOT NULL,
    added INTEGER NOT NULL                  -- Unix time, ms
) STRICT;

CREATE TABLE predictions (
    weights INTEGER NOT NULL REFERENCES weights (id),
    grasp INTEGER NOT NULL REFERENCES grasps (id),
    score REAL NOT NULL,                    -- Refined Network, P(class 1)
    heat REAL,                              -- Regression Network at the grasp's pixel
    PRIMARY KEY (weights, grasp)
) STRICT, WITHOUT ROWID;

CREATE TABLE samples (
    grasp INTEGER PRIMARY KEY REFERENCES grasps (id),
    scene INTEGER NOT NULL REFERENCES scenes (id),
    object INTEGER NOT NULL REFERENCES objects (id),
    split TEXT NOT NULL,
    attempts INTEGER NOT NULL DEFAULT 0,    -- those with a verdict
    successes INTEGER NOT NULL DEFAULT 0,
    collisions INTEGER NOT NULL DEFAULT 0,
    missed INTEGER NOT NULL DEFAULT 0,
    slipped INTEGER NOT NULL DEFAULT 0,
    quality REAL,                           -- successes / attempts
    label REAL,                             -- what training uses; null leaves the sample out
    state TEXT NOT NULL CHECK (state IN ('labelled', 'unlabelled', 'unsure', 'excluded')),
    source TEXT NOT NULL CHECK (source IN ('none', 'dart', 'human')),
    flagged INTEGER NOT NULL DEFAULT 0,
    events INTEGER NOT NULL DEFAULT 0,
    last_event INTEGER,
    score REAL,                             -- of the weights that `meta.weights` names
    heat REAL,
    gap REAL                                -- |score - quality|
) STRICT;
CREATE INDEX samples_scene ON samples (scene, grasp);
CREATE INDEX samples_object ON samples (object, grasp);
CREATE INDEX samples_split ON samples (split, grasp);
CREATE INDEX samples_quality ON samples (quality, grasp);
CREATE INDEX samples_spread ON samples (quality * (1 - quality), grasp);
CREATE INDEX samples_label ON samples (label, grasp);
CREATE INDEX samples_slipped ON samples (slipped, grasp) WHERE slipped > 0;
CREATE INDEX samples_successes ON samples (successes, grasp) WHERE successes > 0;
CREATE INDEX samples_score ON samples (score, grasp) WHERE score IS NOT NULL;
CREATE INDEX samples_heat ON samples (heat, grasp) WHERE heat IS NOT NULL;
CREATE INDEX samples_gap ON samples (gap, grasp) WHERE gap IS NOT NULL;
CREATE INDEX samples_state ON samples (state, grasp) WHERE state <> 'labelled';
CREATE INDEX samples_source ON samples (source, grasp) WHERE source <> 'dart';
CREATE INDEX samples_flagged ON samples (grasp) WHERE flagged = 1;
CREATE INDEX samples_last_event ON samples (last_event, grasp) WHERE last_event IS NOT NULL;
"""

_VERSION_2 = """
-- disagreements that lists sort by; computed, so that they never differ from what they follow from
ALTER TABLE samples ADD COLUMN mistake REAL GENERATED ALWAYS AS (abs(score - label)) VIRTUAL;
ALTER TABLE samples ADD COLUMN networks REAL GENERATED ALWAYS AS (abs(heat - score)) VIRTUAL;
ALTER TABLE samples ADD COLUMN dissent REAL GENERATED ALWAYS AS
    (CASE WHEN source = 'human' THEN abs(label - quality) END) VIRTUAL;
ALTER TABLE samples ADD COLUMN spread REAL GENERATED ALWAYS AS (quality * (1 - quality)) VIRTUAL;
DROP INDEX samples_spread;
CREATE INDEX samples_spread ON samples (spread, grasp);
CREATE INDEX samples_mistake ON samples (mistake, grasp) WHERE mistake IS NOT NULL;
CREATE INDEX samples_networks ON samples (networks, grasp) WHERE networks IS NOT NULL;
CREATE INDEX samples_dissent ON samples (dissent, grasp) WHERE dissent IS NOT NULL;

CREATE TABLE reviews (                      -- queues of samples that one person looks through
    id INTEGER PRIMARY KEY,
    person INTEGER NOT NULL REFERENCES people (id),
    rule TEXT NOT NULL,                     -- JSON, see review.Rule
    made INTEGER NOT NULL                   -- Unix time, ms
) STRICT;
CREATE INDEX reviews_person ON reviews (person, id);

CREATE TABLE review_items (
    review INTEGER NOT NULL REFERENCES reviews (id),
    place INTEGER NOT NULL,
    grasp INTEGER NOT NULL REFERENCES grasps (id),
    truth REAL,                             -- of hidden samples of known outcome
    event INTEGER REFERENCES label_events (id),     -- the answer
    skipped INTEGER NOT NULL DEFAULT 0 CHECK (skipped IN (0, 1)),
    PRIMARY KEY (review, place)
) STRICT, WITHOUT ROWID;
"""

MIGRATIONS: tuple[str, ...] = (_VERSION_1, _VERSION_2)
"""Script i brings a dataset from version i to i + 1; scripts that were released never change."""
