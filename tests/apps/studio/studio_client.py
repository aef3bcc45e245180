"""`scumble studio` as a program that a script talks to: started, called over HTTP, ended."""
import http.client
import json
import subprocess
import threading
from urllib.parse import urlencode


class Studio:
    """The running program. `arguments` come after `scumble studio`."""

    def __init__(self, program, *arguments, **popen):
        self.process = subprocess.Popen([str(program), "studio", *map(str, arguments), "--no-browser"],
                                        stdout=subprocess.PIPE, text=True, **popen)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            raise SystemExit(f"the studio did not start: exit code {self.process.wait()}")
        self.port = int(self.address.split(":")[2].split("/")[0])
        self.connection = self.connect()
        self.connection.request("GET", self.address[self.address.index("/?"):])
        answer = self.connection.getresponse()
        answer.read()
        self.headers = {"Cookie": answer.getheader("Set-Cookie").split(";")[0], "X-Scumble": "1"}

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)

    def call(self, method, path, body=None, **query):
        """(status, headers, body). A body of bytes is a PNG, any other is sent as JSON."""
        headers = dict(self.headers)
        if body is not None:
            headers["Content-Type"] = "image/png" if isinstance(body, bytes) else "application/json"
            body = body if isinstance(body, bytes) else json.dumps(body)
        self.connection.request(method, path + ("?" + urlencode(query) if query else ""), body, headers)
        answer = self.connection.getresponse()
        return answer.status, answer.headers, answer.read()

    def json(self, method, path, body=None, **query):
        """What is answered with 200."""
        status, _, text = self.call(method, path, body, **query)
        if status != 200:
            raise SystemExit(f"{method} {path}: {status}: {text.decode(errors='replace')}")
        return json.loads(text)

    def listen(self, heard):
        """Calls heard(name, data) for every event, on a thread of its own, until the studio ends."""
        def run():
            connection = self.connect()
            try:
                connection.request("GET", "/api/events", headers=self.headers)
                stream, name = connection.getresponse(), ""
                for line in stream.fp:
                    kind, _, text = line.decode().rstrip("\n").partition(": ")
                    if kind == "event":
                        name = text
                    elif kind == "data":
                        heard(name, json.loads(text))
            except (OSError, http.client.HTTPException):
                pass  # it has ended

        threading.Thread(target=run, daemon=True).start()

    def end(self):
        """The exit code."""
        self.connection.close()
        self.process.terminate()
        self.process.stdout.close()
        return self.process.wait(60)
