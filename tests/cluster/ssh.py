"""GNU parallel over ssh: `python3 tests/cluster/ssh.py`.

Two nodes, each an sshd of its own on this machine with its own port, keys and configuration; one job at a time on each. One node is
killed with all that it has at work, as where a machine goes down; `--retries` gives its shards to the other, and
`--resume-failed` does those that failed there, too, when the node is back.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import common

NODES = ["node1", "node2"]
SSHD = """
ListenAddress 127.0.0.1
Port {port}
HostKey {folder}/host
AuthorizedKeysFile {folder}/user.pub
PidFile {folder}/{name}.pid
StrictModes no
UsePAM no
PasswordAuthentication no
"""
CLIENT = """
Host {name}
    HostName 127.0.0.1
    Port {port}
    IdentityFile {folder}/user
    IdentitiesOnly yes
    StrictHostKeyChecking no
    UserKnownHostsFile {folder}/known
    LogLevel ERROR
"""


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Nodes:
    """The machines that are pretended."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("host", "user"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(folder / name)], check=True)
        os.makedirs("/run/sshd", exist_ok=True)
        self.ports = {name: free_port() for name in NODES}
        client = "".join(CLIENT.format(name=name, port=port, folder=folder) for name, port in self.ports.items())
        (folder / "ssh").write_text(client)
        self.servers = {name: self.started(name) for name in NODES}

    def started(self, name):
        config = self.folder / f"{name}.sshd"
        config.write_text(SSHD.format(name=name, port=self.ports[name], folder=self.folder))
        server = subprocess.Popen(["/usr/sbin/sshd", "-D", "-f", str(config)])
        for _ in range(100):
            if subprocess.run(["ssh", "-F", str(self.folder / "ssh"), name, "true"], check=False).returncode == 0:
                return server
            time.sleep(0.1)
        sys.exit(f"FAILED: {name} does not answer")

    def below(self, top):
        """A process and all that it started."""
        parents = {}
        for process in Path("/proc").iterdir():
            if process.name.isdigit():
                try:
                    parents[int(process.name)] = int((process / "stat").read_text().rsplit(")", 1)[1].split()[1])
                except OSError:
                    continue
        found = [top]
        for one in found:
            found += [child for child, parent in parents.items() if parent == one]
        return found

    def kill(self, name):
        for process in self.below(self.servers[name].pid):
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.servers[name].wait()


def start(sweep, more):
    """Starts parallel on both nodes."""
    logins = ",".join(f"1/{name}" for name in NODES)
    words = ["parallel", "--will-cite", "--ssh", f"ssh -F {sweep.folder}/ssh", "--sshlogin", logins, "--wd", ".",
             "--joblog", "jobs", "--retries", "3", *more]
    numbers = [str(k) for k in range(1, common.SHARDS + 1)]
    told = open(sweep.folder / "told", "a", encoding="utf-8")
    return subprocess.Popen([*words, *sweep.shard("{}"), ":::", *numbers], stderr=told, cwd=sweep.folder)


def main():
    common.install("parallel openssh-server openssh-client", ["parallel", "sshd", "ssh", "ssh-keygen"])
    sweep = common.Sweep()
    nodes = Nodes(sweep.folder)
    try:
        alone = sweep.whole()
        begun = time.monotonic()
        parallel = start(sweep, [])
        work = sweep.wait_for_middle()
        lost, process = next(iter(work.items()))
        name = next(name for name in NODES if process in nodes.below(nodes.servers[name].pid))
        kept = sweep.kept(lost)
        nodes.kill(name)
        common.tell(f"killed {name} (-9) that had {kept} cells of shard {lost}")
        first = parallel.wait()
        lines = (sweep.folder / "jobs").read_text().splitlines()[1:]
        done = {line.split("\t")[-1] for line in lines if line.split("\t")[6] == "0"}
        common.tell(f"parallel ended with {first}: {len(done)} shards done, those of {name} by the other")
        if first != 0:
            nodes.servers[name] = nodes.started(name)
            again = start(sweep, ["--resume-failed"]).wait()
            common.tell(f"{name} is back; --resume-failed ended with {again}")
            if again != 0:
                sys.exit(f"FAILED: {(sweep.folder / 'told').read_text()}")
        seconds = time.monotonic() - begun
        sweep.finish("GNU parallel over ssh, two nodes", seconds, alone)
    finally:
        for name in NODES:
            nodes.kill(name)


if __name__ == "__main__":
    main()
