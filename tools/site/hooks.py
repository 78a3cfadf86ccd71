"""The index for the search as a script: a page opened from disk may not fetch JSON."""
import os


def on_post_build(config):
    folder = os.path.join(config["site_dir"], "search")
    with open(os.path.join(folder, "search_index.json"), encoding="utf-8") as file:
        index = file.read()
    with open(os.path.join(folder, "search_index.js"), "w", encoding="utf-8") as file:
        file.write("var screeIndex = " + index + ";\n")
    for name in ("search_index.json", "worker.js"):
        os.remove(os.path.join(folder, name))
