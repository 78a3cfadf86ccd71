"""Each sentence of the page on security is held by a file and a text in it, or by a check here (security.txt)."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
PAGE = ROOT / "docs/reference/security.md"
HOLDS = ROOT / "tests/docs/security.txt"  # SENTENCE => FILE: TEXT


def sources():
    for path in sorted((ROOT / "src").rglob("*.[ch]")):
        if "vendor" not in path.parts:
            yield path, path.read_text(encoding="utf-8", errors="replace")


def no_network():
    """No function of sockets is called, and no library of transfers is linked."""
    calls = re.compile(r"\b(socket|getaddrinfo|gethostbyname|curl_\w+|WSAStartup)\s*\(")
    return [f"{path}: {m.group()}" for path, text in sources() for m in calls.finditer(text)]


def starts_nothing_else():
    """Processes are started by the platform alone, for studies; libraries are loaded for the GPU alone."""
    wrong = []
    rules = {
        r"\b(system|popen|execl|execlp|execv|execvp|execve|fork|posix_spawnp?|CreateProcessW|_wspawn\w*)\s*\(":
            {"platform_unix.c", "platform_windows.c"},
        r"\bscree_process_run\s*\(":
            {"platform.h", "platform_unix.c", "platform_windows.c", "platform_wasm.c", "command_base.c", "study_jobs.c",
             "study_slurm.c"},
        r"\b(dlopen|LoadLibrary\w*)\s*\(": {"cuda_driver.c"},
    }
    for path, text in sources():
        for pattern, allowed in rules.items():
            if path.name not in allowed:
                wrong += [f"{path}: {m.group()}" for m in re.finditer(pattern, text)]
    return wrong


def main():
    wrong, held = [], 0
    rows = dict(row.split(" => ") for row in HOLDS.read_text(encoding="utf-8").splitlines())
    sentences = [line[2:] for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("- ")]
    wrong += [f"{PAGE}: names no test in {HOLDS.name}: {s}" for s in sentences if s not in rows]
    wrong += [f"{HOLDS}: not on the page: {s}" for s in rows if s not in sentences]
    for sentence, held_by in rows.items():
        name, text = held_by.split(": ", 1)
        path = ROOT / name
        if path.name == "security.py":
            wrong += [f"{sentence} {what}" for what in globals()[text]()]
        elif not path.exists() or text not in path.read_text(encoding="utf-8"):
            wrong.append(f"{sentence} {name} has no '{text}'")
        held += 1
    print("\n".join(wrong) or f"{held} sentences are held")
    return 1 if wrong or held < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
