"""Recordings of ROS 2 in SQLite for tests, with the tables of rosbag2 before and since it keeps definitions."""

import sqlite3
from contextlib import closing

#: Tables as rosbag2 makes them, before and since it keeps definitions.
OLD = (
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT "
    "NULL, offered_qos_profiles TEXT NOT NULL); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
    "timestamp INTEGER NOT NULL, data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
)
NEW = OLD + (
    "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL, "
    "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
)


def write_db3(path, topics, tables=OLD, definitions=(), page=4096):
    """Write {topic: (type, [(time, payload)])} as rosbag2 does; ``definitions``: (type, language, text)."""
    with closing(sqlite3.connect(path)) as base:
        base.execute(f"PRAGMA page_size={page}")
        base.executescript(tables)
        fill(base, topics)
        for row in definitions:
            base.execute("INSERT INTO message_definitions VALUES(NULL, ?, ?, ?, '')", row)
        base.commit()
    return path


def fill(base, topics):
    """Insert the topics and their messages, those of all topics in the order of time."""
    rows = []
    for number, (topic, (kind, messages)) in enumerate(topics.items(), 1):
        base.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (number, topic, kind))
        rows += [(t, number, payload) for t, payload in messages]
    insert(base, sorted(rows))


def insert(base, rows):
    """Insert messages (time, topic's number, payload)."""
    base.executemany("INSERT INTO messages(timestamp, topic_id, data) VALUES(?, ?, ?)", rows)
