"""An S3 server that lists many objects of a bucket, page by page, and has none of them: ``python listing_server.py PORT OBJECTS``.

Source of the answer: ListObjectsV2, https://docs.aws.amazon.com/AmazonS3/latest/API/API_ListObjectsV2.html
"""

import sys
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit

PAGE = 1000  #: objects, as S3 sends them
CONTENT = (
    "<Contents><Key>{key}</Key><LastModified>2026-01-01T00:00:00.000Z</LastModified><ETag>&quot;{number:032x}&quot;</ETag>"
    "<Size>1000000</Size><StorageClass>STANDARD</StorageClass></Contents>"
)


def key_of(number):
    """Return the key of an object; keys are in the order of their numbers."""
    return f"drives/v{number // 600:05d}/s{number // 100:05d}/{number:08d}.mcap"


class Handler(BaseHTTPRequestHandler):
    """Answers each request with the page that its token names."""

    protocol_version = "HTTP/1.1"
    objects = 0

    def log_message(self, *_):
        """Say nothing."""

    def do_GET(self):
        """Send a page."""
        asked = parse_qs(urlsplit(self.path).query)
        here = self.objects if asked.get("prefix", [""])[0].startswith("drives") else 0
        first = int(asked.get("continuation-token", ["0"])[0])
        last = min(first + PAGE, here)
        rows = "".join(CONTENT.format(key=key_of(number), number=number) for number in range(first, last))
        more = last < here
        token = f"<NextContinuationToken>{last}</NextContinuationToken>" if more else ""
        body = (
            f'<?xml version="1.0" encoding="UTF-8"?><ListBucketResult><Name>fleet</Name><KeyCount>{last - first}</KeyCount>'
            f"<MaxKeys>{PAGE}</MaxKeys><IsTruncated>{str(more).lower()}</IsTruncated>{token}{rows}</ListBucketResult>"
        ).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/xml")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


if __name__ == "__main__":
    Handler.objects = int(sys.argv[2])
    ThreadingHTTPServer(("127.0.0.1", int(sys.argv[1])), Handler).serve_forever()
