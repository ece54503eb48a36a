"""A Slurm cluster of this one machine, in a folder of its own: munged, slurmctld and slurmd with a private configuration, run by whoever
runs the test and stopped at the end."""
import os
import secrets
import shutil
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol"]


def find(name):
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def missing():
    return [name for name in PROGRAMS if not find(name)]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class Cluster:
    def __init__(self, folder):
        self.folder = os.path.join(folder, "slurm")
        self.processes = []
        self.environment = {"SLURM_CONF": self.path("slurm.conf")}

    def path(self, name):
        return os.path.join(self.folder, name)

    def __enter__(self):
        for name in ("", "munge", "state", "spool"):
            os.makedirs(self.path(name), mode=0o755, exist_ok=True)
            os.chmod(self.path(name), 0o755)
        os.chmod(os.path.dirname(self.folder), 0o755)
        try:
            self.start_munge()
            self.start_slurm()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start(self, name, *arguments):
        log = open(self.path(name + ".log"), "w")
        self.processes.append(subprocess.Popen([find(name), *arguments], stdout=log, stderr=log,
                                               env={**os.environ, **self.environment}))

    def start_munge(self):
        key, at = self.path("munge/key"), self.path("munge/socket")
        with open(key, "wb") as file:
            file.write(secrets.token_bytes(1024))
        os.chmod(key, 0o600)
        # --force: a temporary folder's parents may be written by everybody.
        self.start("munged", "--foreground", "--force", "--key-file=" + key, "--socket=" + at, "--pid-file=" + self.path("munge/pid"),
                   "--log-file=" + self.path("munge/log"), "--seed-file=" + self.path("munge/seed"))
        self.wait(lambda: os.path.exists(at), "munged")

    def start_slurm(self):
        user = __import__("pwd").getpwuid(os.getuid()).pw_name
        controller, node = free_ports(2)
        with open(self.path("slurm.conf"), "w") as file:
            file.write(f"""ClusterName=weir
SlurmctldHost=localhost(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={self.path("munge/socket")}
CredType=cred/munge
SlurmctldPort={controller}
SlurmdPort={node}
StateSaveLocation={self.path("state")}
SlurmdSpoolDir={self.path("spool")}
SlurmctldPidFile={self.path("slurmctld.pid")}
SlurmdPidFile={self.path("slurmd.pid")}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
ReturnToService=2
MpiDefault=none
NodeName=here NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes=here Default=YES MaxTime=INFINITE State=UP
""")
        self.start("slurmctld", "-D", "-c", "-f", self.path("slurm.conf"))
        self.start("slurmd", "-D", "-N", "here", "-f", self.path("slurm.conf"))
        self.wait(self.is_idle, "slurmctld and slurmd")

    def is_idle(self):
        shown = subprocess.run([find("scontrol"), "show", "node", "here"], capture_output=True, text=True,
                               env={**os.environ, **self.environment})
        return "State=IDLE" in shown.stdout

    def wait(self, ready, what):
        deadline = time.time() + 60
        while not ready():
            if time.time() > deadline or any(p.poll() is not None for p in self.processes):
                logs = [name for name in os.listdir(self.folder) if name.endswith(".log")]
                said = "\n".join(f"{name}:\n" + open(self.path(name)).read()[-2000:] for name in sorted(logs))
                raise AssertionError(f"{what} did not start\n{said}")
            time.sleep(0.1)

    def __exit__(self, *unused):
        for process in reversed(self.processes):
            process.terminate()
        for process in reversed(self.processes):
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
