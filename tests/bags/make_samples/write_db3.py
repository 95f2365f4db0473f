#!/usr/bin/python3
"""write_db3.py MCAP FOLDER: converts the messages of an MCAP file without chunks to rosbag2's database.

The tables are those of rosbag2_storage_default_plugins (version 3 of its schema).
"""
import os
import sqlite3
import struct
import sys


def text(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    return data[at + 4:at + 4 + size].decode(), at + 4 + size


def main(source, folder):
    os.makedirs(folder)
    name = os.path.basename(folder) + "_0.db3"
    database = sqlite3.connect(os.path.join(folder, name))
    database.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
    database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                     "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                     "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    database.execute("INSERT INTO schema VALUES (3, 'humble')")
    data, at, schemas, seen = open(source, "rb").read(), 8, {}, set()
    while at < len(data) - 8:
        op, size = struct.unpack_from("<BQ", data, at)
        body = data[at + 9:at + 9 + size]
        at += 9 + size
        if op == 3:
            schemas[struct.unpack_from("<H", body)[0]] = text(body, 2)[0]
        elif op == 4 and struct.unpack_from("<H", body)[0] not in seen:
            channel, schema = struct.unpack_from("<HH", body)
            seen.add(channel)
            topic, end = text(body, 4)
            database.execute("INSERT INTO topics VALUES (?, ?, ?, ?, '')",
                             (channel + 1, topic, schemas[schema], text(body, end)[0]))
        elif op == 5:
            channel, _, time = struct.unpack_from("<HIQ", body)
            database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                             (channel + 1, time, body[22:]))
        elif op == 15:
            break
    database.commit()
    database.execute("VACUUM")
    with open(os.path.join(folder, "metadata.yaml"), "w") as metadata:
        metadata.write("rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
                       "  relative_file_paths:\n    - %s\n" % name)


if __name__ == "__main__":
    main(*sys.argv[1:])
