# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A Dask scheduler and its workers as processes, for tests that kill some of them."""
import os
import subprocess
import sys

from tests.cli.test_cohort import wait_until


class Cluster:
    """A scheduler and workers of one slot each, without the nanny that would start them again."""

    def __init__(self, folder):
        self.file, self.folder, self.workers = folder / "scheduler.json", folder, []
        self.scheduler = self.start("scheduler", "--scheduler-file", self.file, "--port", 0, "--host", "127.0.0.1", "--no-dashboard")
        wait_until(self.file.exists, 60)

    def start(self, *words, environment={}):
        return subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_" + words[0], *map(str, words[1:])],
                                stdout=subprocess.DEVNULL, stderr=open(self.folder / "dask.txt", "a"), cwd=self.folder,
                                env={**os.environ, **environment})

    def add_worker(self, environment={}):
        self.workers.append(self.start("worker", "--scheduler-file", self.file, "--nthreads", 1, "--no-nanny", "--no-dashboard",
                                       "--local-directory", self.folder, "--death-timeout", 10, environment=environment))
        return self.workers[-1]

    def client(self):
        import distributed  # which tests without Dask do not have

        return distributed.Client(scheduler_file=str(self.file), set_as_default=False)

    def stop(self):
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()
