// SPDX-License-Identifier: MIT
// Copyright (c) The lutgen authors
// Runs image.elf, a WebAssembly module: writes the queries into its memory, prints what it says.
import { readFileSync } from "node:fs";

const { exports } = (await WebAssembly.instantiate(readFileSync(process.argv[2]))).instance;
const queries = readFileSync("queries.bin");
new Uint8Array(exports.memory.buffer).set(queries, exports.queries.value);
exports.run();
const bytes = new Uint8Array(exports.memory.buffer);
const at = exports.text.value;
const length = new DataView(exports.memory.buffer).getUint32(exports.length.value, true);
process.stdout.write(Buffer.from(bytes.slice(at, at + length)).toString());
