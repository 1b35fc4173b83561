"""A proxy that cuts every connection after some bytes. Arguments: port of the server, number of bytes."""

import socket
import sys
import threading

server, most = int(sys.argv[1]), int(sys.argv[2])


def serve(client, passed):
    with client, socket.create_connection(("127.0.0.1", server)) as upstream:
        upstream.sendall(client.recv(65536))
        while passed > 0 and (chunk := upstream.recv(min(passed, 4096))):
            client.sendall(chunk)
            passed -= len(chunk)


with socket.create_server(("127.0.0.1", 0)) as listener:
    print(listener.getsockname()[1], flush=True)
    turn = 0
    while True:
        turn += 1
        # Each connection is longer, so that an event with all impacts since the last cut passes in the end.
        threading.Thread(target=serve, args=(listener.accept()[0], most + 997 * turn), daemon=True).start()
