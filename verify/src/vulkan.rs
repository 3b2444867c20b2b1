//! Whether this machine has what a Vulkan adapter needs: the loader, and a driver that the loader would find.
//!
//! Nothing is opened: the loader's own rules for finding drivers are followed on paper.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// What is there.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Vulkan {
    /// The loader, `libvulkan.so.1`.
    pub(crate) loader: Option<PathBuf>,
    /// Manifests of drivers whose library is there, too.
    pub(crate) drivers: Vec<PathBuf>,
}

const LOADER: &str = "libvulkan.so.1";

impl Vulkan {
    /// Looks around. `None` where the system brings a graphics interface of its own (Metal, DirectX), so nothing can be missing.
    pub(crate) fn find() -> Option<Self> {
        if cfg!(any(target_os = "macos", target_os = "windows")) {
            return None;
        }
        let variable = |name: &str| std::env::var_os(name);
        let libraries = library_folders(variable);
        let manifests = manifests(variable);
        Some(Self {
            loader: find_library(LOADER, &libraries),
            drivers: manifests.into_iter().filter(|path| has_library(path, &libraries)).collect(),
        })
    }

    /// Whether an adapter can be expected.
    pub(crate) fn is_complete(&self) -> bool {
        self.loader.is_some() && !self.drivers.is_empty()
    }

    /// What is missing, in words.
    pub(crate) fn missing(&self) -> String {
        let loader = self.loader.is_none().then_some("the Vulkan loader (libvulkan.so.1)");
        let driver = self.drivers.is_empty().then_some("a Vulkan driver (no usable icd.d/*.json)");
        let missing: Vec<&str> = loader.into_iter().chain(driver).collect();
        missing.join(" and ")
    }
}

/// The manifests that the loader would read: those that the variables name and no others, or all in the standard folders.
fn manifests(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let list = |name: &str| -> Vec<PathBuf> {
        variable(name).map(|paths| std::env::split_paths(&paths).collect()).unwrap_or_default()
    };
    let forced = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find(|name| variable(name).is_some());
    let places = match forced {
        Some(name) => list(name),
        None => {
            let home = variable("HOME").map(PathBuf::from);
            let one = |name: &str, in_home: &str| -> Vec<PathBuf> {
                let own = home.as_ref().map(|home| home.join(in_home));
                variable(name).map(PathBuf::from).or(own).into_iter().collect()
            };
            let many = |name: &str, usual: &[&str]| {
                let given = list(name);
                if given.is_empty() { usual.iter().map(PathBuf::from).collect() } else { given }
            };
            let roots = [
                one("XDG_CONFIG_HOME", ".config"),
                many("XDG_CONFIG_DIRS", &["/etc/xdg"]),
                vec!["/usr/local/etc".into(), "/etc".into()],
                one("XDG_DATA_HOME", ".local/share"),
                many("XDG_DATA_DIRS", &["/usr/local/share", "/usr/share"]),
            ];
            let folders = roots.into_iter().flatten().map(|root| root.join("vulkan/icd.d"));
            list("VK_ADD_DRIVER_FILES").into_iter().chain(folders).collect()
        }
    };
    let mut found: Vec<PathBuf> = places.iter().flat_map(|place| manifests_at(place)).collect();
    found.sort();
    found.dedup();
    found
}

/// A manifest, or all in a folder.
fn manifests_at(place: &Path) -> Vec<PathBuf> {
    if place.is_file() {
        return vec![place.to_owned()];
    }
    let files = std::fs::read_dir(place).into_iter().flatten().flatten().map(|entry| entry.path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "json")).collect()
}

/// Whether the library that a manifest names is there. Containers often hold the manifest of a driver whose library the host
/// did not lend.
fn has_library(manifest: &Path, folders: &[PathBuf]) -> bool {
    let library = || -> Option<String> {
        let text = std::fs::read_to_string(manifest).ok()?;
        let json: serde_json::Value = serde_json::from_str(&text).ok()?;
        Some(json.get("ICD")?.get("library_path")?.as_str()?.to_owned())
    };
    let Some(library) = library() else { return false };
    if library.contains('/') {
        // A relative path counts from the manifest's folder; an absolute one replaces it.
        return manifest.parent().is_some_and(|folder| folder.join(library).is_file());
    }
    find_library(&library, folders).is_some()
}

/// Where the system's linker looks, near enough: the folders of the variable, the usual ones, and those for an architecture.
fn library_folders(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let given = variable("LD_LIBRARY_PATH");
    let mut folders: Vec<PathBuf> =
        given.iter().flat_map(std::env::split_paths).filter(|path| path.is_absolute()).collect();
    for usual in ["/usr/local/lib", "/usr/lib", "/lib", "/usr/lib64", "/lib64", "/run/opengl-driver/lib"] {
        let usual = PathBuf::from(usual);
        let inside = std::fs::read_dir(&usual).into_iter().flatten().flatten();
        let is_multiarch =
            |name: &OsString| name.to_string_lossy().starts_with(&format!("{}-", std::env::consts::ARCH));
        folders.extend(inside.filter(|entry| is_multiarch(&entry.file_name())).map(|entry| entry.path()));
        folders.push(usual);
    }
    folders
}

fn find_library(name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(folder: &Path, name: &str, library: &str) -> PathBuf {
        let path = folder.join(name);
        std::fs::write(&path, format!(r#"{{"ICD": {{"library_path": "{library}", "api_version": "1.3"}}}}"#))
            .unwrap();
        path
    }

    #[test]
    fn a_driver_counts_only_with_its_library() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let icd = manifest(at, "a.json", "libdriver.so");
        assert!(!has_library(&icd, &[at.to_owned()]));
        std::fs::write(at.join("libdriver.so"), "").unwrap();
        assert!(has_library(&icd, &[at.to_owned()]) && !has_library(&icd, &[]));
        assert!(has_library(&manifest(at, "b.json", "./libdriver.so"), &[]));
        assert!(!has_library(&manifest(at, "c.json", "/nowhere/libdriver.so"), &[at.to_owned()]));
        std::fs::write(at.join("d.json"), "{ \"ICD\": 3").unwrap();
        assert!(!has_library(&at.join("d.json"), &[at.to_owned()]) && !has_library(&at.join("e.json"), &[]));
    }

    #[test]
    fn variables_replace_and_extend_the_folders() {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("share");
        let icd_folder = data.join("vulkan/icd.d");
        std::fs::create_dir_all(&icd_folder).unwrap();
        let installed = manifest(&icd_folder, "a.json", "x");
        let other = manifest(folder.path(), "other.json", "x");
        std::fs::write(icd_folder.join("readme.txt"), "").unwrap();
        let found = |set: &[(&str, &Path)]| {
            let set: Vec<(String, OsString)> =
                set.iter().map(|(name, value)| ((*name).to_owned(), value.as_os_str().to_owned())).collect();
            let empty = folder.path().join("empty").into_os_string();
            manifests(move |name| {
                let given = set.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone());
                given.or_else(|| name.starts_with("XDG").then(|| empty.clone()))
            })
        };
        let usual = found(&[]);
        let with = |more: &[&PathBuf]| {
            let mut all: Vec<PathBuf> = usual.iter().chain(more.iter().copied()).cloned().collect();
            all.sort();
            all
        };
        assert_eq!(found(&[("XDG_DATA_DIRS", &data)]), with(&[&installed]));
        assert_eq!(
            found(&[("XDG_DATA_HOME", &data), ("VK_ADD_DRIVER_FILES", &other)]),
            with(&[&installed, &other])
        );
        assert_eq!(
            found(&[("XDG_DATA_DIRS", &data), ("VK_ICD_FILENAMES", &other)]),
            std::slice::from_ref(&other)
        );
        assert_eq!(
            found(&[("VK_DRIVER_FILES", &icd_folder), ("VK_ICD_FILENAMES", &other)]),
            std::slice::from_ref(&installed)
        );
    }

    #[test]
    fn what_is_missing_is_named() {
        let nothing = Vulkan::default();
        assert!(nothing.missing().contains("libvulkan.so.1") && nothing.missing().contains("icd.d"));
        let all = Vulkan { loader: Some("l".into()), drivers: vec!["d".into()] };
        assert!(all.is_complete() && all.missing().is_empty());
    }
}
