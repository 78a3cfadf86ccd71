#!/usr/bin/env node
// The program scree: verbs, options, files and exit codes are those of the native one.
import { readFileSync } from 'node:fs';
import { isatty } from 'node:tty';
import createScree from '../lib/scree.cjs';

const wasmBinary = readFileSync(new URL('../lib/scree.wasm', import.meta.url));
const program = await createScree({ wasmBinary, isTerminal: isatty });
process.exitCode = program.callMain(process.argv.slice(2));
