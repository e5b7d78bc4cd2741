//! Fingerprint of the core's sources: SHA-256 over every file that can move a result.
//!
//! The key of a cached result holds it, so that changed physics never meets an old frame.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use sha2::{Digest, Sha256};

/// Adds the files below `folder` to `files`.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let root = here.join("../..").canonicalize()?;
    let core = root.join("crates/railsim");

    let mut files = vec![core.join("Cargo.toml"), root.join("Cargo.lock")];
    collect(&core.join("src"), &mut files)?;
    files.sort();

    let mut hash = Sha256::new();
    for file in &files {
        // Name and length first: moving bytes from one file to the next must change the sum.
        let name = file.strip_prefix(&root)?.to_string_lossy().replace('\\', "/");
        let bytes = fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
        hash.update(format!("{name}\n{}\n", bytes.len()));
        hash.update(&bytes);
        println!("cargo::rerun-if-changed={}", file.display());
    }
    // A folder's time changes when a file comes or goes.
    println!("cargo::rerun-if-changed={}", core.join("src").display());

    let mut hex = String::new();
    for byte in hash.finalize() {
        write!(hex, "{byte:02x}")?;
    }
    println!("cargo::rustc-env=RAILSIM_FINGERPRINT={hex}");
    Ok(())
}
