// SPDX-License-Identifier: BSD-3-Clause
// A target needs a source file; this one's only purpose is its precompiled header.
int main() {}
