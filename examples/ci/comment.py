#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a summary as a comment of a pull request of GitHub or a merge request of GitLab.

usage: comment.py SUMMARY

A comment of an earlier run, which begins with the same first line, is replaced. The place and the
token come from the environment:

GitHub: GITHUB_API_URL, GITHUB_REPOSITORY, PULL_REQUEST (its number), GITHUB_TOKEN
GitLab: CI_API_V4_URL, CI_PROJECT_ID, CI_MERGE_REQUEST_IID, GITLAB_TOKEN (scope api)
"""
import json
import os
import pathlib
import sys
import urllib.request


def request(method, url, headers, body=None):
    data = None if body is None else json.dumps({"body": body}).encode()
    call = urllib.request.Request(url, data, {**headers, "Content-Type": "application/json"}, method=method)
    with urllib.request.urlopen(call, timeout=60) as answer:
        return json.load(answer)


def place(env):
    """Address of the list of comments, of one comment, method of a change, and headers."""
    if env.get("PULL_REQUEST"):
        root = f"{env['GITHUB_API_URL']}/repos/{env['GITHUB_REPOSITORY']}/issues"
        return (f"{root}/{env['PULL_REQUEST']}/comments", f"{root}/comments", "PATCH",
                {"Authorization": f"Bearer {env['GITHUB_TOKEN']}", "Accept": "application/vnd.github+json"})
    if env.get("CI_MERGE_REQUEST_IID"):
        notes = (f"{env['CI_API_V4_URL']}/projects/{env['CI_PROJECT_ID']}/merge_requests/"
                 f"{env['CI_MERGE_REQUEST_IID']}/notes")
        return notes, notes, "PUT", {"PRIVATE-TOKEN": env["GITLAB_TOKEN"]}
    sys.exit("comment.py: neither PULL_REQUEST nor CI_MERGE_REQUEST_IID is set; see its first lines")


def main(summary):
    body = pathlib.Path(summary).read_text(encoding="utf-8")
    comments, comment, change, headers = place(os.environ)
    mark = body.splitlines()[0]
    earlier = [c["id"] for c in request("GET", f"{comments}?per_page=100", headers) if c["body"].startswith(mark)]
    if earlier:
        request(change, f"{comment}/{earlier[0]}", headers, body)
    else:
        request("POST", comments, headers, body)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
