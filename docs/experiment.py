"""Remote control of foci live from an experiment; needs only the Python standard library.

    foci live study.toml --socket 5005
    python3 experiment.py 5005
"""

import socket
import sys
import time


class Foci:
    def __init__(self, port, host="127.0.0.1"):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(15)
        self.socket.connect((host, port))

    def ask(self, command):
        """Sends a command and returns the answer without its "ok". Raises RuntimeError if foci refuses the command."""
        self.socket.send(command.encode())
        answer = self.socket.recv(4096).decode().strip()
        if not answer.startswith("ok"):
            raise RuntimeError(answer)
        return answer[3:]

    def push(self, samples):
        """Pushes gaze to `foci live --source socket`: rows of (time_s, x_px, y_px) or (time_s, x_px, y_px, pupil_mm).

        The time is on the tracker's clock. nan in x_px or y_px stands for data loss. Returns how many rows foci has
        taken; prints what else foci says, for example that none of the gaze is used.
        """
        text = ";".join(" ".join(f"{value:.9g}" if i else f"{value:.6f}" for i, value in enumerate(row))
                        for row in samples)
        count, _, remark = self.ask("gaze " + text).partition(" ")
        if remark:
            print("foci:", remark, file=sys.stderr)
        return int(count)


def main():
    if len(sys.argv) != 2 or not sys.argv[1].isdigit():
        sys.exit("usage: python3 experiment.py PORT")
    try:
        foci = Foci(int(sys.argv[1]))
        foci.ask("record trial-1")
        for pupil_mm in (2, 4, 8):
            foci.ask(f"set observer.pupil_mm {pupil_mm}")
            print("began at", foci.ask(f"mark pupil {pupil_mm}"), "s")
            time.sleep(2)
        foci.ask("stop")
    except (OSError, OverflowError) as error:
        sys.exit(f"no answer at port {sys.argv[1]}: {error}; first: foci live STUDY --socket {sys.argv[1]}")
    except RuntimeError as error:
        sys.exit(f"foci answers: {error}")


if __name__ == "__main__":
    main()
